// SPDX-License-Identifier: Apache-2.0
// From `{"x", "m", range(-1, 1)}` to the declaration of a port: what each option may be given to, and what it sets.
#pragma once

#include <cstring>
#include <type_traits>

#include "chimera/task/collector.h"
#include "chimera/task/fields.h"
#include "chimera/task/options.h"

namespace chimera::component_api {

template <class T>
inline constexpr bool kIsInitial = false;
template <class V>
inline constexpr bool kIsInitial<InitialIs<V>> = true;
template <class V>
inline constexpr bool kIsInitial<InitialListIs<V>> = true;

/// Says in a sentence why an option does not go with a kind of port.
template <std::uint32_t Kind, class Option>
constexpr bool check_option() {
  static_assert(!kIsInitial<Option> || Kind == CHIMERA_OUT_VAR || Kind == CHIMERA_IN_CONST,
                "initial goes with an out-var (its value at spawn) or an in-const (its default): an in-var gets its "
                "first value from its producer");
  static_assert(!std::is_same_v<Option, SafetyIs> || Kind == CHIMERA_OUT_VAR,
                "safety goes with an out-var: it guards what is published");
  static_assert(!std::is_same_v<Option, AtLeastIs> || Kind == CHIMERA_IN_CONST,
                "at_least goes with an in-const, and names another: it is checked before anything runs");
  static_assert(!std::is_same_v<Option, OneOfIs> || Kind == CHIMERA_IN_CONST,
                "one_of goes with an in-const of text: it is checked before anything runs");
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
void apply_option(chimera_port_decl& port, Collector&, const SafetyIs&) {
  port.flags |= CHIMERA_PORT_SAFETY;
}
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const FrameIs& option) { port.frame = option.text; }
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const DocIs& option) { port.doc = option.text; }
template <class E>
void apply_option(chimera_port_decl& port, Collector&, const TypeIs& option) { port.type_name = option.text; }

/// The declaration that T alone makes.
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

/// True when the fields leave out at least one member: a gap that padding cannot explain.
inline bool leaves_out_a_member(const chimera_port_decl& port, std::size_t align) {
  std::size_t end = 0;
  for (std::uint32_t i = 0; i < port.n_fields; ++i) {
    const chimera_field& field = port.fields[i];
    if (field.offset >= end + align) return true;
    end = field.offset + std::size_t{field.count} * field.size;
  }
  return port.element_size >= end + align;
}

/// Where a port's live half lies; `instances` and `max` only for a repeated one.
struct PortPlace {
  const void* live;
  const void* instances = nullptr;
  std::uint32_t max = 1;
};

/// Declares a port to the collector, when one is at work. Context: setup.
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
