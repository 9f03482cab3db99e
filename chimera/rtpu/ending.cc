// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/ending.h"

#include <algorithm>

namespace chimera {

std::vector<TaskId> ending_order(const ApplicationSpec& spec) {
  std::vector<TaskId> order(spec.start.rbegin(), spec.start.rend());
  for (std::size_t t = spec.tasks.size(); t-- > 0;)
    if (std::find(order.begin(), order.end(), TaskId(t)) == order.end()) order.push_back(TaskId(t));
  std::stable_partition(order.begin(), order.end(), [&](TaskId id) { return !spec.tasks[id.index].is_hardware; });
  return order;
}

}  // namespace chimera
