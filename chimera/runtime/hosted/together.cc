// SPDX-License-Identifier: Apache-2.0
// Adds hot standbys to a set, and exchanges primaries for their standbys.
#include "chimera/runtime/hosted/together.h"

#include <algorithm>

namespace chimera {
namespace {

/// A hot standby that is not ON cycles while another task of its group is ON.
void add_hot(std::span<const StandbySpec> standbys, std::vector<TaskId>& tasks) {
  const std::vector<TaskId> on = tasks;
  for (const StandbySpec& each : standbys) {
    const auto is_mate = [&](TaskId task) { return primary_of(standbys, task) == each.primary; };
    if (each.hot && std::ranges::any_of(on, is_mate) && std::ranges::count(on, each.standby) == 0)
      tasks.push_back(each.standby);
  }
}

}  // namespace

std::vector<Together> all_together(std::span<const StandbySpec> standbys, std::span<const TaskId> set) {
  std::vector<Together> all{{{set.begin(), set.end()}, {}, {}}};
  for (const StandbySpec& each : standbys) {
    if (std::ranges::count(set, each.primary) == 0 || std::ranges::count(set, each.standby) > 0) continue;
    all.push_back({{set.begin(), set.end()}, each.primary, each.standby});
    std::ranges::replace(all.back().tasks, each.primary, each.standby);
  }
  for (Together& each : all) add_hot(standbys, each.tasks);
  return all;
}

}  // namespace chimera
