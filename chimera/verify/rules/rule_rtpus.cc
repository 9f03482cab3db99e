// SPDX-License-Identifier: Apache-2.0
// Rules on rtpus: each task has one, and the priority bands of rtpus on one CPU do not overlap.
#include <algorithm>

#include "chimera/description/criticality.h"
#include "chimera/description/draft_values.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

DraftRtpu default_rtpu() {
  DraftRtpu rtpu;
  rtpu.name.text = "main";
  return rtpu;
}

void place(Model& model, TaskModel& task) {
  const auto& name = task.draft->rtpu;
  if (!name) return;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < model.rtpus.size(); ++i) {
    names.push_back(model.rtpus[i].name.text);
    if (names.back() == name->text) {
      task.rtpu = i;
      return;
    }
  }
  const std::string near = nearest(name->text, names);
  model.error("rtpu-unknown", name->at,
              "task '" + task.name() + "' names the rtpu '" + name->text + "', which is not there", name->text,
              listed(names), near, near.empty() ? "there are: " + listed(names) : "");
}

/// The task of `rtpu` with the highest or lowest criticality, or nullptr.
const TaskModel* extreme(const Model& model, std::size_t rtpu, bool highest) {
  const TaskModel* best = nullptr;
  for (const TaskModel& task : model.tasks) {
    if (task.rtpu != rtpu) continue;
    const bool better =
        best == nullptr || (highest ? task.criticality > best->criticality : task.criticality < best->criticality);
    if (better) best = &task;
  }
  return best;
}

/// Requires: `above` has the higher band.
void compare_bands(Model& model, std::size_t above, std::size_t below) {
  const TaskModel* low = extreme(model, above, false);
  const TaskModel* high = extreme(model, below, true);
  if (low == nullptr || high == nullptr || low->criticality >= high->criticality) return;
  const std::string cpu = std::to_string(model.rtpus[above].cpu.value);
  model.error("rtpu-band", low->draft->name.at,
              "CPU " + cpu + ": task '" + low->name() + "' (" + criticality_name(low->criticality) + ") on rtpu '" +
                  model.rtpus[above].name.text + "' would go before task '" + high->name() + "' (" +
                  criticality_name(high->criticality) + ") on rtpu '" + model.rtpus[below].name.text + "'",
              criticality_name(low->criticality), std::string("at least ") + criticality_name(high->criticality), {},
              "move one of them to the other rtpu, or give the rtpus different CPUs");
}

}  // namespace

void place_tasks(Model& model) {
  model.rtpus = model.draft.rtpus;
  if (model.rtpus.empty()) model.rtpus.push_back(default_rtpu());
  for (std::size_t i = 0; i < model.rtpus.size(); ++i)
    if (model.rtpus[i].is_board()) model.rtpus[i].cpu.value = kFirstBoardCpu + static_cast<std::uint32_t>(i);
  for (TaskModel& task : model.tasks) place(model, task);
}

void check_bands(Model& model) {
  const auto rank = [&](std::size_t rtpu) {
    const TaskModel* task = extreme(model, rtpu, true);
    return task == nullptr ? 0u : task->criticality;
  };
  for (std::size_t i = 0; i < model.rtpus.size(); ++i)
    for (std::size_t j = i + 1; j < model.rtpus.size(); ++j) {
      if (model.rtpus[i].cpu.value != model.rtpus[j].cpu.value) continue;
      const bool first_above = rank(i) >= rank(j);  // a tie: the order of the file
      compare_bands(model, first_above ? i : j, first_above ? j : i);
    }
}

}  // namespace chimera
