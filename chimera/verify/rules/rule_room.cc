// SPDX-License-Identifier: Apache-2.0
// Computes the memory of the variables in the table, after their shapes are settled.
#include <algorithm>
#include <map>
#include <string>

#include "chimera/verify/rules/rules.h"
#include "chimera/verify/values.h"

namespace chimera {

void share_maxima(Model& model) {
  std::map<std::string, std::uint32_t> of_constant;
  for (bool moved = true; moved;) {
    moved = false;
    const auto lower = [&](SolvedExtent& extent, std::uint32_t& most) {
      if (!extent.constant.empty()) {
        auto& shared = of_constant.try_emplace(extent.constant, extent.max).first->second;
        most = std::min(most, shared);
        if (most < shared) moved = true;
        shared = most;
      }
      most = std::min(most, extent.max);
      if (most < extent.max) moved = true;
      extent.max = most;
    };
    for (VariableModel& variable : model.variables)
      for (std::size_t i = 0; i < variable.extents.size(); ++i) {
        std::uint32_t most = variable.extents[i].max;
        for_each_port_of(variable, [&](PortRef ref) {
          LinkedPort& port = model.port(ref);
          if (port.extents.size() == variable.extents.size()) lower(port.extents[i], most);
        });
        lower(variable.extents[i], most);
      }
    for_each_port(model, [&](PortRef, LinkedPort& port) {
      for (SolvedExtent& extent : port.extents) {
        std::uint32_t most = extent.max;
        lower(extent, most);
      }
    });
  }
}

void limit_table(Model& model) {
  constexpr std::uint64_t kMaxTableBytes = 4 << 20;
  std::uint64_t bytes = 0;
  for_each_port(model, [&](PortRef, const LinkedPort& port) {
    if (port.is_producer()) bytes += std::uint64_t{element_count(port.extents)} * port.element_bytes;
  });
  if (bytes <= kMaxTableBytes) return;
  model.error(
      "table-limit", model.draft.subsystem.at,
      "the outputs of all tasks take " + std::to_string(bytes) + " bytes; at most " + std::to_string(kMaxTableBytes),
      std::to_string(bytes), "at most " + std::to_string(kMaxTableBytes), {},
      "large data belongs into a subsystem of its own, attached by a resource port");
}

}  // namespace chimera
