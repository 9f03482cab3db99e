// SPDX-License-Identifier: Apache-2.0
// Links: two passes over all ports, the first counts the entries of each list, the second writes them side by side.
#include "chimera/runtime/hosted/links.h"

#include <cstddef>

namespace chimera {
namespace {

/// Number of the list that a port belongs to: producers of every variable, consumers of every variable, producers of
/// every constant. `count` when it belongs to none.
struct Lists {
  std::size_t variables, constants;

  std::size_t count() const noexcept { return 2 * variables + constants; }
  std::size_t of(const PortSpec& port) const noexcept {
    if (port.kind == CHIMERA_OUT_VAR && port.variable.is_valid()) return port.variable.index;
    if (port.kind == CHIMERA_IN_VAR && port.variable.is_valid()) return variables + port.variable.index;
    if (port.kind == CHIMERA_OUT_CONST && port.constant.is_valid()) return 2 * variables + port.constant.index;
    return count();
  }
};

}  // namespace

void Links::fill(std::span<const TaskSpec> tasks, std::span<const GivenSpec> operators, std::span<Variable> variables,
                 std::span<ConstantSpec> constants) {
  const Lists lists{variables.size(), constants.size()};
  std::vector<std::size_t> first(lists.count() + 2, 0);  // where list i begins; counted one place behind
  for (const TaskSpec& task : tasks)
    for (const PortSpec& port : task.ports) ++first[lists.of(port) + 1];
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  ports_.resize(first[lists.count()]);
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    std::uint32_t index[CHIMERA_OUT_STREAM + 1] = {};  // of the next port, by kind
    for (const PortSpec& port : tasks[t].ports) {
      const std::size_t list = lists.of(port);
      const std::uint32_t mine = index[port.kind]++;
      if (list < lists.count()) ports_[next[list]++] = {TaskId(t), mine, port.intermittent};
    }
  }
  const std::span<const PortOf> all = ports_;
  const auto list = [&](std::size_t i) { return all.subspan(first[i], first[i + 1] - first[i]); };
  for (std::size_t v = 0; v < variables.size(); ++v) {
    variables[v].producers = list(v);
    variables[v].consumers = list(variables.size() + v);
  }
  for (std::size_t c = 0; c < constants.size(); ++c) constants[c].producers = list(2 * variables.size() + c);
  for (std::size_t o = 0; o < operators.size(); ++o)
    if (operators[o].variable.is_valid())
      variables[operators[o].variable.index].operator_index = static_cast<std::uint32_t>(o);
}

}  // namespace chimera
