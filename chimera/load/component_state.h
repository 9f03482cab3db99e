// SPDX-License-Identifier: Apache-2.0
// Memory of the size and alignment of one component state. The component constructs and destroys the state.
#pragma once

#include <utility>

#include "chimera/base/result.h"
#include "chimera/task/abi.h"

namespace chimera {

/// Owns one constructed state. Its address never changes, because ports are bound into it. Movable as a handle.
class ComponentState {
 public:
  /// Allocates state_size zeroed bytes and constructs the state. Refuses if the constructor of the component fails
  /// (with its text), if the component is described wrongly (for example, a port outside the state), or if memory is
  /// short. Context: setup; may block.
  static Result<ComponentState> make(const chimera_component& component);

  ComponentState(ComponentState&& other) noexcept
      : component_(std::exchange(other.component_, nullptr)), state_(std::exchange(other.state_, nullptr)) {}
  ComponentState& operator=(ComponentState&& other) noexcept {
    std::swap(component_, other.component_);
    std::swap(state_, other.state_);
    return *this;
  }
  /// Destroys the state. Context: setup; may block.
  ~ComponentState();

  void* state() const noexcept { return state_; }
  const chimera_component& component() const noexcept { return *component_; }

 private:
  ComponentState(const chimera_component& component, void* state) noexcept : component_(&component), state_(state) {}

  const chimera_component* component_;
  void* state_;
};

}  // namespace chimera
