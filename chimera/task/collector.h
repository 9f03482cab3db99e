// SPDX-License-Identifier: Apache-2.0
// How ports are declared once: while one sample instance is constructed, each port handle adds itself here, with its
// place in the object. Instances that are constructed to run find no collector and add nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string_view>

#include "chimera/task/abi.h"

namespace chimera::component_api {

/// Puts the parts one behind the other into `size` bytes, cut to what fits with the zero behind them. Context: any;
/// wait-free.
inline void put_text(char* to, std::size_t size, std::initializer_list<std::string_view> parts) noexcept {
  std::size_t n = 0;
  for (const std::string_view part : parts)
    for (const char c : part)
      if (n + 1 < size) to[n++] = c;
  to[n] = '\0';
}

/// Everything declared about one component. Lives in the object's static storage.
struct Declaration {
  chimera_component component{};
  chimera_port_decl ports[CHIMERA_MAX_PORTS] = {};
  chimera_order orders[CHIMERA_MAX_PORTS] = {};
  chimera_choice choices[CHIMERA_MAX_PORTS] = {};
  char error[CHIMERA_FAULT_TEXT] = {};  ///< why the component cannot be used; "" when it can
  std::size_t kept = 0;
  alignas(16) std::byte memory[8192] = {};  ///< initial values, and names without their '*'
};

/// Takes ports while it lives. Context: setup.
class Collector {
 public:
  Collector(Declaration& to, const void* sample, std::size_t size) noexcept
      : to_(to), sample_(static_cast<const std::byte*>(sample)), size_(size), outer_(current_) { current_ = this; }
  ~Collector() { current_ = outer_; }
  Collector(const Collector&) = delete;
  Collector& operator=(const Collector&) = delete;

  static Collector* current() noexcept { return current_; }

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

  /// Notes that no element of the constant `lower` is above that of `upper`.
  void add_order(const char* lower, const char* upper) noexcept {
    std::uint32_t& n = to_.component.n_orders;
    if (n == CHIMERA_MAX_PORTS) return refuse(upper, "is one too many with at_least");
    to_.orders[n++] = {lower, upper};
  }

  /// Notes the words that the constant `port` may be.
  void add_choice(const char* port, const char* words) noexcept {
    std::uint32_t& n = to_.component.n_choices;
    if (n == CHIMERA_MAX_PORTS) return refuse(port, "is one too many with one_of");
    to_.choices[n++] = {port, words};
  }

  /// A copy of `bytes` that lives as long as the declaration; null when there is no more room.
  std::byte* keep(const void* bytes, std::size_t size) noexcept {
    const std::size_t at = (to_.kept + 15) / 16 * 16;
    if (at + size > sizeof(to_.memory)) return nullptr;
    std::memcpy(to_.memory + at, bytes, size);
    to_.kept = at + size;
    return to_.memory + at;
  }

  /// Notes the first reason why the component cannot be used.
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

#if __STDC_HOSTED__
  // One per thread: another thread may construct an instance to run at the same time.
  static inline thread_local Collector* current_ = nullptr;
#else
  static inline Collector* current_ = nullptr;  // there is one thread
#endif

  Declaration& to_;
  const std::byte* sample_;
  std::size_t size_;
  Collector* outer_;
};

}  // namespace chimera::component_api
