// SPDX-License-Identifier: Apache-2.0
// Makes the graph of a configuration: a box a task, a line a variable.
#include "chimera/cli/files/graph_of.h"

#include <optional>

#include "chimera/base/hosted/wording.h"

namespace chimera::cli {
namespace {

std::string rate_text(double hz) {
  return hz >= 1000 ? formatted("%g kHz", hz / 1000) : formatted("%g Hz", hz);
}

std::optional<draw::PortKind> kind_of(std::uint32_t kind) {
  switch (kind) {
    case CHIMERA_IN_VAR: return draw::PortKind::kIn;
    case CHIMERA_OUT_VAR: return draw::PortKind::kOut;
    case CHIMERA_IN_CONST: return draw::PortKind::kInConst;
    case CHIMERA_OUT_CONST: return draw::PortKind::kOutConst;
    case CHIMERA_RESOURCE: return draw::PortKind::kResource;
    default: return std::nullopt;  // streams are refused by verification
  }
}

draw::Box box_of(const ConfiguredTask& task) {
  draw::Box box;
  box.name = task.name;
  box.component = task.component;
  box.rate = rate_text(task.rate_hz);
  for (const ConfiguredPort& port : task.ports) {
    const auto kind = kind_of(port.kind);
    if (kind) box.ports.push_back({*kind, port.name, port.variable});
  }
  return box;
}

}  // namespace

draw::Graph graph_of(const Configuration& configuration) {
  draw::Graph graph;
  graph.title = configuration.subsystem();
  for (const ConfiguredTask& task : configuration.tasks()) graph.boxes.push_back(box_of(task));
  for (const ConfiguredVariable& variable : configuration.variables())
    if (variable.is_given) graph.given.push_back(variable.name);
  return graph;
}

}  // namespace chimera::cli
