// SPDX-License-Identifier: Apache-2.0
// Adds hot standbys to a set, and exchanges primaries for their standbys.
#include "chimera/runtime/hosted/together.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"

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

std::optional<Excess> excess_of(const ApplicationSpec& spec, std::span<const TaskId> set, double limit,
                                bool on_one_cpu) {
  const std::vector<Together> all = all_together(spec.standbys, set);
  for (const RtpuSpec& rtpu : spec.rtpus)
    for (const Together& together : all) {
      double load = 0;
      for (const TaskId task : together.tasks) {
        const TaskSpec& each = spec.tasks[task.index];
        if (on_one_cpu || spec.rtpus[each.rtpu.index].cpu == rtpu.cpu) load += load_of(each);
      }
      if (is_beyond(load, limit)) return Excess{rtpu.cpu, load, together};
    }
  return std::nullopt;
}

std::string takeover_text(const ApplicationSpec& spec, const Together& together) {
  const auto name = [&](TaskId task) { return in_quotes(spec.tasks[task.index].name); };
  return together.is_takeover() ? " with " + name(together.standby) + " for " + name(together.primary) : "";
}

std::string excess_text(const ApplicationSpec& spec, const Excess& excess) {
  return "the budgets" + takeover_text(spec, excess.together) + formatted(" would take %.3f of CPU ", excess.load) +
         std::to_string(excess.cpu) + formatted("; expected at most %.2f", kMaxUtilisation);
}

}  // namespace chimera
