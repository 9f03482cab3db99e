// SPDX-License-Identifier: Apache-2.0
// The declaration of a component, and its collector: while one sample instance is constructed, each port adds its
// declaration, with its place in the object. Instances that are constructed to run find no collector and add nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "chimera/task/abi.h"
#include "chimera/task/bounded_text.h"

namespace chimera::component_api {

/// The whole declaration of one component. Lives in the static storage of the object.
struct Declaration {
  chimera_component component{};
  chimera_port_decl ports[CHIMERA_MAX_PORTS] = {};
  chimera_order orders[CHIMERA_MAX_PORTS] = {};
  chimera_choice choices[CHIMERA_MAX_PORTS] = {};
  char error[CHIMERA_FAULT_TEXT] = {};  ///< the reason why the component is unusable; "" if it is usable
  std::size_t kept = 0;
  alignas(16) std::byte memory[8192] = {};  ///< initial values, and names without their '*'
};

class Collector;
struct CollectorOfThread {
  std::uint64_t mark;
  Collector* current;
};

/// Collects ports during its lifetime. Context: setup.
class Collector {
 public:
  Collector(Declaration& to, const void* sample, std::size_t size) noexcept
      : to_(to), sample_(static_cast<const std::byte*>(sample)), size_(size), outer_(slot()) { slot() = this; }
  ~Collector() { slot() = outer_; }
  Collector(const Collector&) = delete;
  Collector& operator=(const Collector&) = delete;

  static Collector* current() noexcept { return slot(); }

  /// Adds a port whose live half lies at `live`; `instances` is null unless the port is repeated.
  void add(chimera_port_decl port, const void* live, const void* instances) noexcept {
    std::uint32_t& n = to_.component.n_ports;
    if (n == CHIMERA_MAX_PORTS) return refuse(port.name, "is one too many: a component has at most 64 ports");
    for (std::uint32_t i = 0; i < n; ++i)
      if (std::strcmp(to_.ports[i].name, port.name) == 0) return refuse(port.name, "is declared twice");
    if (!place(live, port.live_offset) || (instances != nullptr && !place(instances, port.instances_offset)))
      return refuse(port.name, "must be a member of the component, not on the heap or static");
    to_.ports[n++] = port;
  }

  /// Records that no element of the constant `lower` is above that of `upper`.
  void add_order(const char* lower, const char* upper) noexcept {
    std::uint32_t& n = to_.component.n_orders;
    if (n == CHIMERA_MAX_PORTS) return refuse(upper, "is one too many with at_least");
    to_.orders[n++] = {lower, upper};
  }

  /// Records the legal words of the constant `port`.
  void add_choice(const char* port, const char* words) noexcept {
    std::uint32_t& n = to_.component.n_choices;
    if (n == CHIMERA_MAX_PORTS) return refuse(port, "is one too many with one_of");
    to_.choices[n++] = {port, words};
  }

  /// A copy of `bytes` that lives as long as the declaration; null if no room is left.
  std::byte* keep(const void* bytes, std::size_t size) noexcept {
    const std::size_t at = (to_.kept + 15) / 16 * 16;
    if (at + size > sizeof(to_.memory)) return nullptr;
    std::memcpy(to_.memory + at, bytes, size);
    to_.kept = at + size;
    return to_.memory + at;
  }

  /// Records the first reason why the component is unusable.
  void refuse(const char* port, const char* reason) noexcept {
    if (to_.error[0] == '\0') put_text(to_.error, sizeof(to_.error), {"port ", port, " ", reason});
  }

 private:
  bool place(const void* at, std::uint32_t& offset) const noexcept {
    const auto* byte = static_cast<const std::byte*>(at);
    if (byte < sample_ || byte >= sample_ + size_) return false;
    offset = static_cast<std::uint32_t>(byte - sample_);
    return true;
  }

  // One per thread, because another thread may construct an instance to run at the same time. The mark distinguishes it
  // from variables of the component when an object is checked.
  static inline thread_local CollectorOfThread of_thread_{CHIMERA_THREAD_MARK, nullptr};
  static Collector*& slot() noexcept { return of_thread_.current; }

  Declaration& to_;
  const std::byte* sample_;
  std::size_t size_;
  Collector* outer_;
};

}  // namespace chimera::component_api
