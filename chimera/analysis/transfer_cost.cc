// SPDX-License-Identifier: Apache-2.0
// Counts the groups and bytes that a task copies at each cycle.
#include "chimera/analysis/transfer_cost.h"

#include <algorithm>
#include <vector>

namespace chimera {

TransferCost transfer_of(const Configuration& configuration, std::size_t task) {
  TransferCost cost;
  std::vector<std::size_t> producers;
  const ConfiguredTask& me = configuration.tasks()[task];
  const bool is_preemptive = configuration.rtpus()[me.rtpu].preemptive;
  const auto ports = configuration.spec().tasks[task].ports;
  for (const ConfiguredVariable& variable : configuration.variables()) {
    if (variable.is_constant) continue;
    const auto mine = std::find_if(variable.consumers.begin(), variable.consumers.end(),
                                   [task](const PortRef& ref) { return ref.task == task; });
    if (mine == variable.consumers.end()) continue;
    const std::size_t from = variable.producers.empty() ? SIZE_MAX : variable.producers[0].task;  // the operator
    if (from != SIZE_MAX && !is_preemptive && configuration.tasks()[from].rtpu == me.rtpu) continue;
    cost.bytes += ports[mine->port].max_bytes();
    if (std::find(producers.begin(), producers.end(), from) == producers.end()) producers.push_back(from);
  }
  cost.groups = static_cast<std::uint32_t>(producers.size());
  return cost;
}

}  // namespace chimera
