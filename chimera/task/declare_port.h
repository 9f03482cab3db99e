// SPDX-License-Identifier: Apache-2.0
// Turns `{"x", "m", range(-1, 1)}` into the declaration of a port: which ports accept each option, and what it sets.
// With CHIMERA_BARE no port has a declaration: it reports its form and place (wiring.h), and names and options leave
// the program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "chimera/task/abi.h"
#include "chimera/task/fields.h"
#include "chimera/task/options.h"
#ifdef CHIMERA_BARE
#include "chimera/task/wiring.h"
#else
#include "chimera/task/collector.h"
#endif

namespace chimera::component_api {

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

/// The place of the live half of a port; `instances` is only for a repeated port.
struct PortPlace {
  const void* live;
  const void* instances = nullptr;
};

#ifdef CHIMERA_BARE

/// Reports a port to the wiring, if one is active. N: the most instances of a repeated port; 0 for any other port.
/// Context: setup.
template <class T, std::uint32_t Kind, std::uint32_t N, class... Options>
void declare_port(const char*, const char*, const char*, PortPlace place, const Options&...) {
  static_assert(check_element<typename PortType<T>::Element>());
  static_assert((check_option<Kind, Options>() && ...));
  Wiring::report(kPortForm<T, Kind, N>, place.live);
}

#else

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

/// Declares a port to the collector, if one is active. N: the most instances of a repeated port; 0 for any other port.
/// Context: setup.
template <class T, std::uint32_t Kind, std::uint32_t N, class... Options>
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
    port.max_instances = N;
  }
  if constexpr (std::is_same_v<E, Any>) {
    static_assert(!(kIsInitial<Options> || ...), "a port of any type has no initial value: none fits all types");
    (apply_option<char>(port, *to, options), ...);
  } else {
    (apply_option<E>(port, *to, options), ...);
  }
  to->add(port, place.live, place.instances);
}

#endif

}  // namespace chimera::component_api
