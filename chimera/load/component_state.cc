// SPDX-License-Identifier: Apache-2.0
// Allocates the state of a component with its own alignment.
#include "chimera/load/component_state.h"

#include <cstring>
#include <new>

#include "chimera/base/message.h"

namespace chimera {
namespace {

std::align_val_t alignment(const chimera_component& component) noexcept {
  return std::align_val_t{component.state_align < 16 ? 16 : component.state_align};
}

}  // namespace

Result<ComponentState> ComponentState::make(const chimera_component& component) {
  const std::size_t size = component.state_size == 0 ? 1 : component.state_size;
  void* state = ::operator new(size, alignment(component), std::nothrow);
  if (state == nullptr) {
    return (Message() << "component " << component.name << ": no memory for a state of " << component.state_size
                      << " bytes")
        .error(ErrorCode::kSystem);
  }
  std::memset(state, 0, size);
  chimera_fault fault{};
  if (component.construct(state, &fault) == CHIMERA_OK) return ComponentState(component, state);
  ::operator delete(state, alignment(component));
  return (Message() << "component " << component.name << " cannot be made: " << fault.text)
      .error(ErrorCode::kRefused);
}

ComponentState::~ComponentState() {
  if (state_ == nullptr) return;
  component_->destroy(state_);
  ::operator delete(state_, alignment(*component_));
}

}  // namespace chimera
