// SPDX-License-Identifier: Apache-2.0
// Checks that each published value of a run is written, finite and within the range of its port.
#include "chimera/component_test/judge_values.h"

#include <cmath>

#include "chimera/base/hosted/wording.h"
#include "chimera/component_test/record.h"
#include "chimera/task/number_at.h"

namespace chimera::component_test {
namespace {

std::optional<std::string> why_unsound(double value, const PortSpec& spec, bool with_ranges) {
  if (std::isnan(value)) return "is NaN";
  if (std::isinf(value)) return "is infinite";
  if (!with_ranges || !spec.has_range || (value >= spec.min && value <= spec.max)) return std::nullopt;
  return formatted("is %g", value) + formatted(", outside %g", spec.min) + formatted(" to %g", spec.max);
}

std::optional<std::string> unsound_element(const std::byte* at, const PortSpec& spec, const PortDescriptor& port,
                                           bool with_ranges) {
  if (spec.type != CHIMERA_STRUCT) return why_unsound(number_at(spec.type, at), spec, with_ranges);
  for (const FieldDescriptor& field : port.fields)
    for (std::uint32_t i = 0; i < field.count; ++i)
      if (const auto why = why_unsound(number_at(field.type, at + field.offset + i * field.size), spec, false))
        return "." + field.name + " " + *why;
  return std::nullopt;
}

}  // namespace

std::optional<std::string> first_unsound(const Configuration& configuration, const Descriptor& component,
                                         std::span<const std::uint32_t> counts, std::span<const std::byte> outputs,
                                         std::uint64_t valid, bool with_ranges) {
  std::size_t payload = 0;
  const auto places = output_places(configuration.spec(), payload);
  for (std::size_t o = 0; o < places.size(); ++o) {
    const PortSpec& spec = *places[o].spec;
    const PortDescriptor& port = component.ports[spec.declared];
    const std::string name = port.name + (port.repeated ? "[" + std::to_string(spec.instance) + "]" : "");
    if (((valid >> o) & 1u) == 0) return name + " is never written";
    for (std::uint32_t i = 0; i < counts[o]; ++i) {
      const std::byte* at = outputs.data() + places[o].offset + i * spec.element_bytes;
      if (const auto why = unsound_element(at, spec, port, with_ranges))
        return name + (counts[o] == 1 ? "" : "[" + std::to_string(i) + "]") + (why->starts_with(".") ? "" : " ") + *why;
    }
  }
  return std::nullopt;
}

}  // namespace chimera::component_test
