// SPDX-License-Identifier: Apache-2.0
// The rules for a declaration, from an object or from a file. One function for each rule.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "chimera/load/descriptor.h"
#include "chimera/load/utf8.h"

namespace chimera {
namespace {

/// "" if the declaration keeps the rule, otherwise the reason.
using Verdict = std::string;

bool is_type_name(std::string_view text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !text.empty() && text.size() <= 64 && is_letter(text.front()) &&
         std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

std::string name_fault(std::string_view what, std::string_view name) {
  return std::string(what) + " \"" + std::string(name) + "\" is no legal name: [a-z][a-z0-9_]*, at most 64 letters";
}

Verdict size_rule(std::uint32_t type, std::uint32_t size) {
  const std::uint32_t expected = type_size(type);
  if (expected != 0 && size != expected) {
    return std::string(type_name(type)) + " takes " + std::to_string(expected) + " bytes, declared are " +
           std::to_string(size);
  }
  if (expected == 0 && (size == 0 || size > 4096)) {
    return "an element of " + std::to_string(size) + " bytes; a " + std::string(type_name(type)) +
           " takes 1 to 4096";
  }
  return {};
}

Verdict kind_rule(const PortDescriptor& port) {
  if (port.kind > CHIMERA_OUT_STREAM) return "unknown kind " + std::to_string(port.kind);
  if (port.type > CHIMERA_ANY) return "unknown type " + std::to_string(port.type);
  if (port.kind == CHIMERA_RESOURCE) {
    if (port.type != CHIMERA_STRING) return "a resource is a string, declared is " + std::string(type_name(port.type));
    if (!port.shape.empty()) return "a resource has no shape, declared is \"" + port.shape + "\"";
    return {};
  }
  return size_rule(port.type, port.element_size);
}

Verdict type_name_rule(const PortDescriptor& port) {
  const bool wanted = port.type == CHIMERA_STRUCT || port.type == CHIMERA_ANY;
  if (wanted && !is_type_name(port.type_name)) {
    return "type name \"" + port.type_name + "\" is no legal name: [A-Za-z][A-Za-z0-9_]*, at most 64 letters";
  }
  if (!wanted && !port.type_name.empty()) {
    return "type name \"" + port.type_name + "\" on a " + std::string(type_name(port.type));
  }
  return {};
}

Verdict field_rule(const PortDescriptor& port, const FieldDescriptor& field, std::uint32_t free_from) {
  const std::string place = "field " + field.name + ": ";
  if (!is_identifier(field.name)) return name_fault("field", field.name);
  if (field.type > CHIMERA_STRING) return place + "a field is bool, int32, int64, float32, float64 or string";
  if (const Verdict v = size_rule(field.type, field.size); !v.empty()) return place + v;
  if (field.unit.empty()) return place + "the unit is empty; write \"1\" for none";
  if (field.count == 0 || field.count > kMaxExtent) return place + "count " + std::to_string(field.count);
  if (field.offset < free_from) return place + "overlaps the field before it";
  if (std::uint64_t{field.offset} + std::uint64_t{field.size} * field.count > port.element_size) {
    return place + "ends beyond the element of " + std::to_string(port.element_size) + " bytes";
  }
  return {};
}

Verdict fields_rule(const PortDescriptor& port) {
  if (port.type != CHIMERA_STRUCT) return port.fields.empty() ? Verdict() : "fields on a port that is no struct";
  if (port.fields.empty()) return "a struct without fields";
  if (port.fields.size() > 64) return "more than 64 fields";
  std::uint32_t free_from = 0;
  for (std::size_t i = 0; i < port.fields.size(); ++i) {
    const FieldDescriptor& field = port.fields[i];
    if (Verdict v = field_rule(port, field, free_from); !v.empty()) return v;
    free_from = field.offset + field.size * field.count;
    for (std::size_t j = 0; j < i; ++j) {
      if (port.fields[j].name == field.name) return "two fields are called " + field.name;
    }
  }
  return {};
}

Verdict instances_rule(const PortDescriptor& port) {
  if (!port.repeated && port.max_instances != 1) {
    return std::to_string(port.max_instances) + " instances of a port that is not repeated";
  }
  if (port.max_instances == 0 || port.max_instances > CHIMERA_MAX_INSTANCES) {
    return std::to_string(port.max_instances) + " instances; 1 to 16 are allowed";
  }
  return {};
}

Verdict range_rule(const PortDescriptor& port) {
  if (!port.has_range) return {};
  if (port.type < CHIMERA_INT32 || port.type > CHIMERA_FLOAT64) {
    return "a range on a " + std::string(type_name(port.type));
  }
  if (!(port.min <= port.max)) {
    return "range from " + std::to_string(port.min) + " to " + std::to_string(port.max) + " is not ordered";
  }
  return {};
}

Verdict words_rule(const PortDescriptor& port) {
  if (port.one_of.empty()) return {};
  if (port.type != CHIMERA_STRING || port.kind != CHIMERA_IN_CONST) {
    return "one of some words: expected an in-const of text";
  }
  if (port.one_of.size() > 64) return std::to_string(port.one_of.size()) + " words, at most 64 are allowed";
  for (std::size_t i = 0; i < port.one_of.size(); ++i) {
    const std::string& word = port.one_of[i];
    if (word.empty() || word.find(' ') != std::string::npos || !is_utf8(word)) {
      return "the word \"" + (is_utf8(word) ? word : "?") + "\": expected text without a space";
    }
    if (word.size() >= port.element_size) {
      return "the word \"" + word + "\" is longer than the port's " + std::to_string(port.element_size - 1) + " bytes";
    }
    if (std::find(port.one_of.begin(), port.one_of.begin() + static_cast<std::ptrdiff_t>(i), word) !=
        port.one_of.begin() + static_cast<std::ptrdiff_t>(i)) {
      return "the word \"" + word + "\" is listed twice";
    }
  }
  return {};
}

Verdict configuration_rule(const PortDescriptor& port) {
  const bool fits = port.type == CHIMERA_STRING && port.kind == CHIMERA_IN_CONST && port.one_of.empty();
  if (port.names_configuration && !fits) return "the name of a configuration: expected an in-const of free text";
  return {};
}

Verdict safe_state_rule(const PortDescriptor& port) {
  const bool says = port.kind == CHIMERA_OUT_VAR && port.type == CHIMERA_BOOL && port.shape.empty() && !port.repeated;
  if (port.safe_state && !says && port.kind != CHIMERA_RESOURCE)
    return "the safe state: expected an out-var of one bool, or a resource that never moves";
  return {};
}

Verdict shared_rule(const PortDescriptor& port) {
  if (port.shared && port.kind != CHIMERA_RESOURCE)
    return "shared is for resources, this is an " + std::string(kind_name(port.kind));
  return {};
}

Verdict intermittent_rule(const PortDescriptor& port) {
  if (port.intermittent && (port.kind != CHIMERA_IN_VAR || !port.initial.empty()))
    return "intermittent is for in-vars without a default";
  return {};
}

Verdict safety_rule(const PortDescriptor& port) {
  if (!port.safety) return {};
  if (port.kind != CHIMERA_OUT_VAR) return "safety is for out-vars, this is an " + std::string(kind_name(port.kind));
  if (port.type != CHIMERA_FLOAT32 && port.type != CHIMERA_FLOAT64) {
    return "a safety port is float32 or float64, declared is " + std::string(type_name(port.type));
  }
  return {};
}

/// A plain initial value: no NaN, truth values 0 or 1, and a text with its closing zero.
Verdict value_rule(std::uint32_t type, const std::byte* at, std::uint32_t size, const PortDescriptor* ranged) {
  double number = 0;
  if (type == CHIMERA_BOOL && std::to_integer<unsigned>(*at) > 1) return "a bool that is neither 0 nor 1";
  if (type == CHIMERA_STRING) {
    const char* text = reinterpret_cast<const char*>(at);
    const std::size_t length = ::strnlen(text, size);
    if (length == size) return "a string without an end";
    if (!is_utf8({text, length})) return "a text that is no UTF-8";
    const bool is_free = ranged == nullptr || ranged->one_of.empty();
    return is_free || std::find(ranged->one_of.begin(), ranged->one_of.end(), std::string_view(text, length)) !=
                          ranged->one_of.end()
               ? Verdict()
               : "\"" + std::string(text, length) + "\" is none of its words";
  }
  if (type == CHIMERA_ANY) {
    const bool zero = std::all_of(at, at + size, [](std::byte b) { return b == std::byte{0}; });
    return zero ? Verdict() : "a type variable can only start at zero";
  }
  if (type == CHIMERA_FLOAT64) std::memcpy(&number, at, 8);
  if (type == CHIMERA_FLOAT32) {
    float narrow = 0;
    std::memcpy(&narrow, at, 4);
    number = static_cast<double>(narrow);
  }
  if (type == CHIMERA_INT32) {
    std::int32_t whole = 0;
    std::memcpy(&whole, at, 4);
    number = whole;
  }
  if (type == CHIMERA_INT64) {
    std::int64_t whole = 0;
    std::memcpy(&whole, at, 8);
    number = static_cast<double>(whole);
  }
  if (std::isnan(number)) return "is not a number";
  if (ranged != nullptr && ranged->safety && std::isinf(number)) return "is infinite on a safety port";
  if (ranged != nullptr && ranged->has_range && (number < ranged->min || number > ranged->max)) {
    return std::to_string(number) + " is outside the range";
  }
  return {};
}

Verdict element_rule(const PortDescriptor& port, const std::byte* element) {
  if (port.type != CHIMERA_STRUCT) return value_rule(port.type, element, port.element_size, &port);
  for (const FieldDescriptor& field : port.fields) {
    for (std::uint32_t i = 0; i < field.count; ++i) {
      const Verdict v = value_rule(field.type, element + field.offset + i * field.size, field.size, nullptr);
      if (!v.empty()) return "field " + field.name + ": " + v;
    }
  }
  return {};
}

Verdict initial_rule(const PortDescriptor& port) {
  if (port.initial.empty()) return {};
  if (port.kind > CHIMERA_IN_CONST || (port.kind == CHIMERA_IN_VAR && port.repeated)) {
    return "an initial value on a" + std::string(port.repeated ? " repeated " : "n ") +
           std::string(kind_name(port.kind)) + "; it is for out-vars, in-consts and in-vars that are not repeated";
  }
  const std::uint32_t count = port.initial_count();
  if (port.initial.size() != std::size_t{count} * port.element_size || (count != 1 && count != port.max_count())) {
    return "initial value of " + std::to_string(count) + " elements; expected 1 or " +
           std::to_string(port.max_count());
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const Verdict v = element_rule(port, port.initial.data() + std::size_t{i} * port.element_size);
    if (!v.empty()) return "initial value " + std::to_string(i) + ": " + v;
  }
  return {};
}

Verdict text_rule(const PortDescriptor& port) {
  for (const std::string* text : {&port.doc, &port.unit, &port.frame}) {
    if (!is_utf8(*text)) return "a text that is no UTF-8";
  }
  for (const FieldDescriptor& field : port.fields) {
    if (!is_utf8(field.unit)) return "a text that is no UTF-8";
  }
  return {};
}

Verdict port_rules(const PortDescriptor& port) {
  if (!is_identifier(port.name)) return name_fault("port", port.name);
  if (port.unit.empty()) return "the unit is empty; write \"1\" for none";
  for (const auto rule :
       {text_rule, kind_rule, type_name_rule, fields_rule, instances_rule, range_rule, words_rule,
        configuration_rule, safe_state_rule, shared_rule, intermittent_rule, safety_rule}) {
    if (Verdict v = rule(port); !v.empty()) return v;
  }
  return {};
}

/// An extent with the name of a port must be a constant whole number, with one meaning everywhere.
Verdict extent_rule(const Descriptor& descriptor, const PortDescriptor& port, const Extent& extent) {
  if (extent.is_literal()) return {};
  const PortDescriptor* giver = descriptor.port(extent.symbol);
  if (giver != nullptr && (!giver->is_constant() || !giver->shape.empty() || giver->repeated ||
                           (giver->type != CHIMERA_INT32 && giver->type != CHIMERA_INT64))) {
    return "shape \"" + port.shape + "\": the port " + extent.symbol + " is no whole-number scalar constant";
  }
  if (giver != nullptr && extent.is_shape) {
    return "shape \"" + port.shape + "\": the port " + extent.symbol + " is one number, and no shape";
  }
  for (const PortDescriptor& other : descriptor.ports) {
    for (const Extent& said : other.extents) {
      if (said.symbol == extent.symbol && said.is_shape != extent.is_shape) {
        return "shape \"" + port.shape + "\": port " + other.name + " has " + extent.symbol + " as " +
               (said.is_shape ? "a shape" : "an extent");
      }
      if (said.symbol == extent.symbol && said.max != extent.max) {
        return "shape \"" + port.shape + "\": port " + other.name + " gives " + extent.symbol + " the maximum " +
               std::to_string(said.max);
      }
    }
  }
  return {};
}

Verdict order_rule(const Descriptor& descriptor, const PortDescriptor& port) {
  if (port.at_least.empty()) return {};
  const PortDescriptor* lower = descriptor.port(port.at_least);
  const bool is_number = port.type >= CHIMERA_INT32 && port.type <= CHIMERA_FLOAT64;
  if (lower != nullptr && lower != &port && is_number && port.kind == CHIMERA_IN_CONST &&
      lower->kind == CHIMERA_IN_CONST && !port.repeated && !lower->repeated && lower->type == port.type &&
      lower->unit == port.unit && lower->shape == port.shape) {
    return {};
  }
  return "at least \"" + port.at_least + "\": expected two in-consts of numbers, of one type, unit and shape";
}

Verdict component_rules(const Descriptor& descriptor) {
  if (!is_identifier(descriptor.name)) return name_fault("component", descriptor.name);
  const double rate = descriptor.default_rate_hz;
  if (!(rate == 0 || (rate >= 1.0 / 3600 && rate <= 1e6))) {
    return "default rate " + std::to_string(rate) + " Hz is not from 1/3600 to 1000000 Hz";
  }
  if (!descriptor.methods[CHIMERA_CYCLE]) return "has no cycle method";
  if (descriptor.event_source && !descriptor.is_aperiodic())
    return "has an event source but no sync to take its events";
  if (!is_utf8(descriptor.doc) || !is_utf8(descriptor.source)) return "a text that is no UTF-8";
  return {};
}

Verdict count_rules(const Descriptor& descriptor) {
  std::uint32_t instances = 0;
  for (std::size_t i = 0; i < descriptor.ports.size(); ++i) {
    instances += descriptor.ports[i].max_instances;
    for (std::size_t j = 0; j < i; ++j) {
      if (descriptor.ports[j].name == descriptor.ports[i].name) {
        return "two ports are called " + descriptor.ports[i].name;
      }
    }
  }
  if (instances <= CHIMERA_MAX_PORTS) return {};
  return std::to_string(instances) + " ports, instances counted; at most 64 are allowed";
}

Error refused(const std::string& place, const std::string& why) {
  const std::string text = place + ": " + why;
  return {ErrorCode::kBadInput, std::string_view(text), {}};
}

}  // namespace

Result<void> complete(Descriptor& descriptor) {
  const std::string place = "component " + descriptor.name;
  if (const Verdict v = component_rules(descriptor); !v.empty()) return refused(place, v);
  for (PortDescriptor& port : descriptor.ports) {
    const std::string port_place = place + ": port " + port.name;
    if (const Verdict v = port_rules(port); !v.empty()) return refused(port_place, v);
    auto extents = parse_shape(port.shape);
    if (!extents) return refused(port_place, std::string(extents.error().message.view()));
    port.extents = *std::move(extents);
    if (const Verdict v = initial_rule(port); !v.empty()) return refused(port_place, v);
  }
  if (const Verdict v = count_rules(descriptor); !v.empty()) return refused(place, v);
  for (const PortDescriptor& port : descriptor.ports) {
    if (const Verdict v = order_rule(descriptor, port); !v.empty()) return refused(place + ": port " + port.name, v);
    for (const Extent& extent : port.extents) {
      const Verdict v = extent_rule(descriptor, port, extent);
      if (!v.empty()) return refused(place + ": port " + port.name, v);
    }
  }
  return {};
}

}  // namespace chimera
