// SPDX-License-Identifier: Apache-2.0
// Turns `{"x", "m", range(-1, 1)}` into the declaration of a port: which ports accept each option, and what it sets.
// While one sample instance is constructed, each port adds its declaration, with its place in the object, to the
// collector. Instances that are constructed to run find no collector and add nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string_view>
#include <type_traits>

#include "chimera/task/abi.h"
#include "chimera/task/fields.h"
#include "chimera/task/options.h"

namespace chimera::component_api {

/// Writes the parts one after another into `size` bytes, cut so that the closing zero fits. Context: any; wait-free.
inline void put_text(char* to, std::size_t size, std::initializer_list<std::string_view> parts) noexcept {
  std::size_t n = 0;
  for (const std::string_view part : parts)
    for (const char c : part)
      if (n + 1 < size) to[n++] = c;
  to[n] = '\0';
}

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

#if __STDC_HOSTED__
  // One per thread, because another thread may construct an instance to run at the same time. The mark distinguishes it
  // from variables of the component when an object is checked.
  static inline thread_local CollectorOfThread of_thread_{CHIMERA_THREAD_MARK, nullptr};
  static Collector*& slot() noexcept { return of_thread_.current; }
#else
  static inline Collector* current_ = nullptr;  // this system has one thread
  static Collector*& slot() noexcept { return current_; }
#endif

  Declaration& to_;
  const std::byte* sample_;
  std::size_t size_;
  Collector* outer_;
};

template <class T>
inline constexpr bool kIsInitial = false;
template <class V>
inline constexpr bool kIsInitial<InitialIs<V>> = true;
template <class V>
inline constexpr bool kIsInitial<InitialListIs<V>> = true;

/// Explains in a sentence why an option does not fit a kind of port.
template <std::uint32_t Kind, class Option>
constexpr bool check_option() {
  static_assert(!kIsInitial<Option> || Kind <= CHIMERA_IN_CONST,
                "initial goes with an out-var (its value at spawn), or with an in-const or in-var (its default)");
  static_assert(!std::is_same_v<Option, SafetyIs> || Kind == CHIMERA_OUT_VAR,
                "safety goes with an out-var: it guards what is published");
  static_assert(!std::is_same_v<Option, AtLeastIs> || Kind == CHIMERA_IN_CONST,
                "at_least goes with an in-const, and names another: it is checked before anything runs");
  static_assert(!std::is_same_v<Option, OneOfIs> || Kind == CHIMERA_IN_CONST,
                "one_of goes with an in-const of text: it is checked before anything runs");
  static_assert(!std::is_same_v<Option, ConfigurationIs> || Kind == CHIMERA_IN_CONST,
                "configuration goes with an in-const of text: it is checked before anything runs");
  static_assert(!std::is_same_v<Option, SafeStateIs> || Kind == CHIMERA_OUT_VAR || Kind == CHIMERA_RESOURCE,
                "safe_state goes with an out-var of bool, or with a resource that never moves");
  static_assert(!std::is_same_v<Option, SharedIs> || Kind == CHIMERA_RESOURCE,
                "shared goes with a resource that several tasks may have open at one time");
  static_assert(!std::is_same_v<Option, IntermittentIs> || Kind == CHIMERA_IN_VAR,
                "intermittent goes with an in-var that some configurations do not produce");
  static_assert(!std::is_same_v<Option, RangeIs> || Kind != CHIMERA_RESOURCE, "a resource has no range");
  return true;
}

template <class E, class V>
E convert_initial(const V& value) {
  if constexpr (std::is_arithmetic_v<E>) {
    static_assert(std::is_convertible_v<const V&, E> && !std::is_class_v<V>, "initial must be a number for this port");
    return static_cast<E>(value);
  } else {
    static_assert(std::is_convertible_v<const V&, E>, "initial must be of the port's type");
    return E(value);
  }
}

template <class E>
void keep_initial(chimera_port_decl& port, Collector& to, const E* values, std::size_t count) {
  port.initial = to.keep(values, count * sizeof(E));
  if (port.initial == nullptr) to.refuse(port.name, "has too large an initial value");
  port.initial_count = static_cast<std::uint32_t>(count);
  port.flags |= CHIMERA_PORT_HAS_INITIAL;
}

template <class E, class V>
void apply_option(chimera_port_decl& port, Collector& to, const InitialIs<V>& option) {
  const E value = convert_initial<E>(option.value);
  keep_initial(port, to, &value, 1);
}

template <class E, class V>
void apply_option(chimera_port_decl& port, Collector& to, const InitialListIs<V>& option) {
  E values[64];
  std::size_t count = 0;
  for (const V& value : option.values) {
    if (count == 64) return to.refuse(port.name, "has more than 64 initial values");
    values[count++] = convert_initial<E>(value);
  }
  keep_initial(port, to, values, count);
}

template <class E>
void apply_option(chimera_port_decl& port, Collector&, const RangeIs& option) {
  port.min = option.min;
  port.max = option.max;
  port.flags |= CHIMERA_PORT_HAS_RANGE;
}
template <class E>
void apply_option(chimera_port_decl& port, Collector& to, const AtLeastIs& option) {
  to.add_order(option.port, port.name);
}
template <class E>
void apply_option(chimera_port_decl& port, Collector& to, const OneOfIs& option) {
  static_assert(element_type<E>() == CHIMERA_STRING, "one_of goes with text: numbers have a range");
  to.add_choice(port.name, option.words);
}
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const ConfigurationIs&) {
  static_assert(element_type<E>() == CHIMERA_STRING, "configuration goes with text: a configuration has a name");
  port.flags |= CHIMERA_PORT_CONFIGURATION;
}
template <class E>
void apply_option(chimera_port_decl& port, Collector& to, const SafeStateIs&) {
  if (port.kind != CHIMERA_RESOURCE && element_type<E>() != CHIMERA_BOOL)
    to.refuse(port.name, "is a safe_state and no bool");
  port.flags |= CHIMERA_PORT_SAFE_STATE;
}
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const SharedIs&) {
  port.flags |= CHIMERA_PORT_SHARED;
}
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const IntermittentIs&) {
  port.flags |= CHIMERA_PORT_INTERMITTENT;
}
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const SafetyIs&) {
  port.flags |= CHIMERA_PORT_SAFETY;
}
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const FrameIs& option) { port.frame = option.text; }
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const DocIs& option) { port.doc = option.text; }
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const TypeIs& option) { port.type_name = option.text; }

/// The part of a declaration that depends on T alone.
template <class T, std::uint32_t Kind>
chimera_port_decl declare_type(const char* name, const char* unit, const char* shape) {
  using E = typename PortType<T>::Element;
  chimera_port_decl port{};
  port.name = name;
  port.doc = port.frame = port.type_name = "";
  port.unit = unit;
  port.shape = shape;
  port.kind = Kind;
  port.type = element_type<E>();
  port.max_instances = 1;
  if constexpr (std::is_same_v<E, Any>) {
    port.element_size = 8;
    port.type_name = "T";
  } else {
    port.element_size = sizeof(E);
    if constexpr (element_type<E>() == CHIMERA_STRUCT) {
      port.type_name = Fields<E>::name;
      port.n_fields = static_cast<std::uint32_t>(kFieldCount<E>);
      port.fields = fields_of<E>();
    }
  }
  return port;
}

/// True if the fields omit at least one member: the struct has a gap that padding cannot explain.
inline bool leaves_out_a_member(const chimera_port_decl& port, std::size_t align) {
  std::size_t end = 0;
  for (std::uint32_t i = 0; i < port.n_fields; ++i) {
    const chimera_field& field = port.fields[i];
    if (field.offset >= end + align) return true;
    end = field.offset + std::size_t{field.count} * field.size;
  }
  return port.element_size >= end + align;
}

/// The place of the live half of a port; `instances` and `max` are only for a repeated port.
struct PortPlace {
  const void* live;
  const void* instances = nullptr;
  std::uint32_t max = 1;
};

/// Declares a port to the collector, if one is active. Context: setup.
template <class T, std::uint32_t Kind, class... Options>
void declare_port(const char* name, const char* unit, const char* shape, PortPlace place, const Options&... options) {
  using E = typename PortType<T>::Element;
  static_assert(check_element<E>());
  static_assert((check_option<Kind, Options>() && ...));
  Collector* to = Collector::current();
  if (to == nullptr) return;
  chimera_port_decl port = declare_type<T, Kind>(name, unit, shape);
  if (port.n_fields != 0 && leaves_out_a_member(port, alignof(E)))
    to->refuse(name, "carries a struct with a member that its Fields do not name");
  if (place.instances != nullptr) {
    const std::size_t size = std::strlen(name);  // "in*": the declaration has no star
    auto* kept = reinterpret_cast<char*>(to->keep(name, size));
    if (kept == nullptr) return to->refuse(name, "has no room for its name");
    kept[size - 1] = '\0';
    port.name = kept;
    port.flags |= CHIMERA_PORT_REPEATED;
    port.max_instances = place.max;
  }
  if constexpr (std::is_same_v<E, Any>) {
    static_assert(!(kIsInitial<Options> || ...), "a port of any type has no initial value: none fits all types");
    (apply_option<char>(port, *to, options), ...);
  } else {
    (apply_option<E>(port, *to, options), ...);
  }
  to->add(port, place.live, place.instances);
}

}  // namespace chimera::component_api
