// SPDX-License-Identifier: Apache-2.0
// Compares a port with all ports of the other direction in the library.
#include "chimera/web/fitting_ports.h"

#include <algorithm>
#include <utility>

#include "chimera/units/unit_expression.h"

namespace chimera::web {
namespace {

enum class PortFit { kNot, kWithVariables, kExact };

/// The kind of the other end of a link; the kind itself for a port without links.
std::uint32_t other_end(std::uint32_t kind) {
  switch (kind) {
    case CHIMERA_IN_VAR:
      return CHIMERA_OUT_VAR;
    case CHIMERA_OUT_VAR:
      return CHIMERA_IN_VAR;
    case CHIMERA_IN_CONST:
      return CHIMERA_OUT_CONST;
    case CHIMERA_OUT_CONST:
      return CHIMERA_IN_CONST;
    default:
      return kind;
  }
}

PortFit fit_of_types(const PortDescriptor& a, const PortDescriptor& b) {
  if (a.type == b.type && a.type != CHIMERA_ANY) return a.type_name == b.type_name ? PortFit::kExact : PortFit::kNot;
  const auto is_plain = [](const PortDescriptor& p) { return p.type <= CHIMERA_FLOAT64 || p.type == CHIMERA_ANY; };
  const bool is_open = a.type == CHIMERA_ANY || b.type == CHIMERA_ANY;
  return is_open && is_plain(a) && is_plain(b) ? PortFit::kWithVariables : PortFit::kNot;
}

/// One unknown must have a solution; more than one, or an unknown on both sides, is left to the verification.
PortFit fit_of_units(const UnitExpression& a, const UnitExpression& b) {
  if (a.is_concrete() && b.is_concrete()) return same(a.rest, b.rest) ? PortFit::kExact : PortFit::kNot;
  if (!a.is_concrete() && !b.is_concrete()) return PortFit::kWithVariables;
  const auto& [open, known] = a.is_concrete() ? std::tie(b, a) : std::tie(a, b);
  return open.unknowns() > 1 || solve(open, known) ? PortFit::kWithVariables : PortFit::kNot;
}

PortFit fit_of_shapes(const PortDescriptor& a, const PortDescriptor& b) {
  const auto is_any = [](const PortDescriptor& p) { return p.extents.size() == 1 && p.extents[0].is_shape; };
  if (is_any(a) || is_any(b)) {
    const auto literal = [](const Extent& e) { return e.is_literal(); };
    for (const auto& [any, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
      const bool is_settled = std::all_of(other->extents.begin(), other->extents.end(), literal);
      if (is_any(*any) && !is_any(*other) && is_settled && other->max_count() > any->max_count()) return PortFit::kNot;
    }
    return PortFit::kWithVariables;
  }
  if (a.extents.size() != b.extents.size()) return PortFit::kNot;
  for (std::size_t i = 0; i < a.extents.size(); ++i) {
    const Extent &one = a.extents[i], &two = b.extents[i];
    if (one.is_literal() && two.is_literal() && one.max != two.max) return PortFit::kNot;
    if (one.is_literal() != two.is_literal() && (one.is_literal() ? one.max > two.max : two.max > one.max))
      return PortFit::kNot;
  }
  return PortFit::kExact;
}

}  // namespace

FittingPorts fitting_ports(const Library& library, const PortDescriptor& port, std::size_t most) {
  FittingPorts found;
  const std::uint32_t wanted = other_end(port.kind);
  const auto unit = library.units().parse_expression(port.unit);
  if (wanted == port.kind || !unit) return found;
  std::vector<FittingPort> exact, others;
  for (const LibraryEntry& entry : library.entries()) {
    for (const PortDescriptor& other : entry.descriptor.ports) {
      if (other.kind != wanted) continue;
      PortFit fit = std::min(fit_of_types(port, other), fit_of_shapes(port, other));
      if (fit == PortFit::kNot) continue;
      const auto other_unit = library.units().parse_expression(other.unit);
      fit = other_unit ? std::min(fit, fit_of_units(*unit, *other_unit)) : PortFit::kNot;
      if (fit != PortFit::kNot)
        (fit == PortFit::kExact ? exact : others).push_back({entry.descriptor.name, other.name});
    }
  }
  found.with = std::move(exact);
  found.with.insert(found.with.end(), others.begin(), others.end());
  found.n_more = found.with.size() - std::min(found.with.size(), most);
  found.with.resize(found.with.size() - found.n_more);
  return found;
}

}  // namespace chimera::web
