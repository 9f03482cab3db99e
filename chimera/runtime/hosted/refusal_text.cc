// SPDX-License-Identifier: Apache-2.0
// Puts refused signals into words.
#include "chimera/runtime/hosted/refusal_text.h"

#include "chimera/runtime/hosted/variables.h"

namespace chimera {

std::string under_way_text(const ApplicationSpec& spec, std::uint32_t set) {
  if (set >= spec.sets.size()) return "a switch is under way";
  return "the switch to '" + std::string(spec.sets[set].name) + "' is under way";
}

std::string refusal_text(TaskSet& set, const SignalReport& report) {
  if (report.is_accepted) return {};
  if (report.why == Refusal::kIllegalSet) {
    const auto wanted = set.life().judge().wanted();
    return Variables(set.spec()).explain({wanted.begin(), wanted.end()}, set.spec().tasks);
  }
  const Task& task = set.tasks()[report.task.index];
  const std::string what = signal_name(report.signal);
  if (report.why == Refusal::kFault) return what + ": " + std::string(task.spec->name) + ": " + task.faults.last.text;
  const std::string name(task.spec->name);
  if (report.why == Refusal::kNotYet) return what + ": " + name + " is not ready yet";
  const SignalJudge& judge = set.life().judge();
  if (const TaskId rival = judge.find_rival(report.task); report.why == Refusal::kRival && rival.is_valid())
    return name + " has the resource '" + std::string(judge.rivals().resource(report.task, rival)) + "' of " +
           std::string(set.spec().tasks[rival.index].name) + ", which is created";
  return what + " is not legal for " + std::string(task.spec->name) + " in state " + state_name(report.before);
}

Result<void> start_result(TaskSet& set, const SignalReport& report) {
  if (report.is_accepted) return {};
  if (report.signal != Signal::kSpawn)
    return Error{ErrorCode::kRefused, {refusal_text(set, report)}, {set.spec().name}};
  const Task& task = set.tasks()[report.task.index];
  return Error{ErrorCode::kRefused, {std::string("init: ") + task.faults.last.text}, {task.spec->name}};
}

}  // namespace chimera
