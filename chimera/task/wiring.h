// SPDX-License-Identifier: Apache-2.0
// How the framework finds the ports of a component whose table has no declarations, as in an image for a
// microcontroller (CHIMERA_BARE): while such a component is constructed, each port reports its form and its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/task/port_form.h"

namespace chimera {

/// A port that a component reported.
struct WiredPort {
  const PortForm* form = nullptr;
  std::uint32_t live_offset = 0;  ///< of the chimera_port (repeated: of the array) in the state
};

/// During its lifetime, takes the ports of components that this thread constructs. Context: setup.
class Wiring {
 public:
  /// Takes the ports of the component in `state` into `ports`, in the order of their declaration. Further ports are
  /// only counted.
  Wiring(std::span<WiredPort> ports, std::span<const std::byte> state) noexcept;
  ~Wiring();
  Wiring(const Wiring&) = delete;
  Wiring& operator=(const Wiring&) = delete;

  /// Reported ports; ports with a larger number than `ports` had are included.
  std::size_t size() const noexcept { return size_; }
  /// True if every port lies in the state.
  bool is_inside() const noexcept { return is_inside_; }

  /// For ports: reports one to the wiring of this thread; without one it does nothing. Context: setup.
  static void report(const PortForm& form, const void* live) noexcept;

 private:
  void add(const PortForm& form, const std::byte* live) noexcept;

  std::span<WiredPort> ports_;
  std::span<const std::byte> state_;
  std::size_t size_ = 0;
  bool is_inside_ = true;
  Wiring* outer_;
};

}  // namespace chimera
