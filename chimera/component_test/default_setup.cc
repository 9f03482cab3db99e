// SPDX-License-Identifier: Apache-2.0
// Makes a description for a component from its descriptor alone.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "chimera/base/assert.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/component_test/setup.h"

namespace chimera::component_test {
namespace {

constexpr double kPlain = 0.5;
constexpr std::uint32_t kInstances = 2;

std::string number_text(double value) { return formatted("%.17g", value); }

// The unit with 1 for its unit variables (single capitals U X Y Z); "1" if no unit remains.
std::string plain_unit(std::string unit) {
  const auto is_letter = [&unit](std::size_t at) {
    return at < unit.size() && std::isalpha(static_cast<unsigned char>(unit[at])) != 0;
  };
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const bool is_alone = (i == 0 || !is_letter(i - 1)) && !is_letter(i + 1);
    if (is_alone && std::string_view("UXYZ").find(unit[i]) != std::string_view::npos) unit[i] = '1';
  }
  return std::ranges::any_of(unit, [](unsigned char c) { return std::isalpha(c) != 0; }) ? unit : "1";
}

bool fixes_extent(const Descriptor& component, const PortDescriptor& port) {
  return std::ranges::any_of(component.ports, [&](const PortDescriptor& other) {
    return std::ranges::any_of(other.extents, [&](const Extent& extent) { return extent.symbol == port.name; });
  });
}

std::uint32_t largest_extent(const Descriptor& component, const std::string& symbol) {
  std::uint32_t most = kMaxExtent;
  for (const PortDescriptor& port : component.ports)
    for (const Extent& extent : port.extents)
      if (extent.symbol == symbol) most = std::min(most, extent.max);
  return most;
}

double middle(const Descriptor& component, const PortDescriptor& port) {
  if (port.is_constant() && fixes_extent(component, port)) return std::min(2u, largest_extent(component, port.name));
  if (!port.has_range) return port.is_constant() ? 1 : kPlain;
  if (std::isfinite(port.min) && std::isfinite(port.max)) return port.min + (port.max - port.min) / 2;
  return std::isfinite(port.min) ? port.min + kPlain : std::isfinite(port.max) ? port.max - kPlain : kPlain;
}

std::string number_with_unit(double value, const std::string& unit) {
  return with_unit(number_text(value), plain_unit(unit));
}

std::string struct_text(const PortDescriptor& port) {
  std::string text;
  for (const FieldDescriptor& field : port.fields) {
    const bool is_turn = port.type_name == "Pose" && field.name == "orientation";
    const std::string items = join_n(field.count, ", ", [&](std::size_t i) {
      return field.type == CHIMERA_STRING ? "\"\""
             : field.type == CHIMERA_BOOL ? "false"
                                          : number_with_unit(is_turn && i == 0 ? 1 : 0, field.unit);
    });
    append_joined(text, ", ", field.name + ": " + (field.count == 1 ? items : "[" + items + "]"));
  }
  return "{" + text + "}";
}

std::string element_text(const Descriptor& component, const PortDescriptor& port) {
  switch (port.type) {
    case CHIMERA_STRING:
      return "\"\"";
    case CHIMERA_BOOL:
      return "false";
    case CHIMERA_STRUCT:
      return struct_text(port);
    case CHIMERA_INT32:
    case CHIMERA_INT64:
      return number_with_unit(std::round(middle(component, port)), port.unit);
    default:
      return number_with_unit(middle(component, port), port.unit);
  }
}

std::string repeated(const std::string& text, std::uint32_t n) {
  return "[" + join_n(n, ", ", [&text](std::size_t) { return text; }) + "]";
}

// One value fills an extent that a constant fixes; a list sets the length of an extent variable.
std::string value_text_of(const Descriptor& component, const PortDescriptor& port) {
  std::string text = element_text(component, port);
  const bool is_open = std::ranges::any_of(port.extents, [&](const Extent& extent) {
    return !extent.is_literal() && component.port(extent.symbol) == nullptr;
  });
  if (!is_open) return text;
  for (std::size_t d = port.extents.size(); d-- > 0;)
    text = repeated(text, port.extents[d].is_literal() ? port.extents[d].max : std::min(2u, port.extents[d].max));
  return text;
}

std::string instance_name(const PortDescriptor& port, std::uint32_t i) { return port.name + "_" + std::to_string(i); }

std::uint32_t instances_of(const PortDescriptor& port) { return std::min(kInstances, port.max_instances); }

}  // namespace

Descriptor settled(const Descriptor& component) {
  Descriptor plain = component;
  for (PortDescriptor& port : plain.ports) {
    if (port.kind != CHIMERA_OUT_VAR) continue;
    port.unit = plain_unit(port.unit);
    if (port.type == CHIMERA_ANY) port.type = CHIMERA_FLOAT64, port.type_name.clear();
    std::string shape;
    for (const Extent& extent : port.extents) {
      const bool is_open = !extent.is_literal() && component.port(extent.symbol) == nullptr;
      shape += "[" +
               (extent.is_literal() ? ""
                : is_open           ? ""
                                    : extent.symbol + "<=") +
               std::to_string(is_open ? 1 : extent.max) + "]";
    }
    port.shape = shape;
  }
  CHIMERA_ASSERT(complete(plain));
  return plain;
}

std::string default_setup(const Descriptor& component) {
  std::string alias, constants, operators;
  for (const PortDescriptor& port : component.ports) {
    const std::string value = value_text_of(component, port);
    if (port.kind == CHIMERA_IN_CONST && port.initial.empty() && !port.repeated)
      constants += "\n      " + port.name + ": " + value;
    if (port.kind == CHIMERA_IN_CONST && port.initial.empty() && port.repeated)
      constants += "\n      " + port.name + ": " + repeated(value, instances_of(port));
    if (port.repeated && (port.kind == CHIMERA_IN_VAR || port.kind == CHIMERA_OUT_VAR)) {
      const auto name = [&port](std::size_t i) { return instance_name(port, static_cast<std::uint32_t>(i)); };
      alias += "\n      " + port.name + ": [" + join_n(instances_of(port), ", ", name) + "]";
    }
    if (port.kind != CHIMERA_IN_VAR) continue;
    if (!port.repeated)
      operators += "\n  " + port.name + ": " + value;
    else
      for (std::uint32_t i = 0; i < instances_of(port); ++i)
        operators += "\n  " + instance_name(port, i) + ": " + value;
  }
  std::string text = "subsystem: trial\ntasks:\n  " + component.name + ":\n    component: " + component.name + "\n";
  if (!(component.default_rate_hz > 0)) text += "    rate: 100 Hz\n";
  if (!alias.empty()) text += "    alias:" + alias + "\n";
  if (!constants.empty()) text += "    constants:" + constants + "\n";
  if (!operators.empty()) text += "operator:" + operators + "\n";
  return text;
}

}  // namespace chimera::component_test
