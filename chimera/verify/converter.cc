// SPDX-License-Identifier: Apache-2.0
// Looks for components with one input in one unit and one output in the other.
#include "chimera/verify/converter.h"

#include "chimera/base/hosted/wording.h"

namespace chimera {
namespace {

/// A component of the library of the framework: y = factor x, for any two units of one dimension.
constexpr const char* kAnyConverter = "unit_convert";

bool is_in(const UnitSystem& units, const PortDescriptor& port, const Unit& wanted) {
  const auto unit = units.parse(port.unit);
  return port.type != CHIMERA_STRUCT && unit && same(*unit, wanted);
}

/// The two variable ports of a component that has no more; none if it has others.
std::optional<Converter> ends_of(const Descriptor& component) {
  Converter ends{component.name, {}, {}};
  for (const PortDescriptor& port : component.ports) {
    if (port.is_constant()) continue;
    std::string& end = port.kind == CHIMERA_IN_VAR ? ends.in : ends.out;
    if (port.kind > CHIMERA_OUT_VAR || port.repeated || !end.empty()) return std::nullopt;
    end = port.name;
  }
  return ends.in.empty() || ends.out.empty() ? std::nullopt : std::optional(ends);
}

std::string part(const std::string& unit) {
  return unit.find_first_of(" .*/^()0123456789") == std::string::npos ? unit : "(" + unit + ")";
}

}  // namespace

std::optional<Converter> converter_of(const Library& library, const WordedUnit& from, const WordedUnit& to) {
  const UnitSystem& units = library.units();
  const auto factor = conversion(from.unit, to.unit);
  if (!factor) return std::nullopt;
  for (const LibraryEntry& entry : library.entries()) {
    auto ends = ends_of(entry.descriptor);
    if (ends && is_in(units, *entry.descriptor.port(ends->in), from.unit) &&
        is_in(units, *entry.descriptor.port(ends->out), to.unit))
      return ends;
  }
  const LibraryEntry* any = library.find(kAnyConverter);
  auto ends = any != nullptr && factor->offset == 0 ? ends_of(any->descriptor) : std::nullopt;
  if (ends) ends->factor = formatted("%.10g ", factor->factor) + part(to.text) + "/" + part(from.text);
  return ends;
}

}  // namespace chimera
