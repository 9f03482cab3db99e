// SPDX-License-Identifier: Apache-2.0
// Puts refused signals into words.
#include "chimera/runtime/hosted/refusal_text.h"

#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/life/refusal_words.h"

namespace chimera {

std::string under_way_text(const ApplicationSpec& spec, std::uint32_t set) {
  if (set >= spec.sets.size()) return "a switch is under way";
  return "the switch to '" + std::string(spec.sets[set].name) + "' is under way";
}

std::string refusal_text(TaskSet& set, const SignalReport& report) {
  if (!report.is_accepted && report.why == Refusal::kIllegalSet) {
    const auto wanted = set.life().judge().wanted();
    return Variables(set.spec()).explain({wanted.begin(), wanted.end()}, set.spec().tasks);
  }
  std::string text;
  put_refusal(set, report, [&text](std::string_view part) { text += part; });
  return text;
}

Result<void> start_result(TaskSet& set, const SignalReport& report) {
  if (report.is_accepted) return {};
  if (report.signal != Signal::kSpawn)
    return Error{ErrorCode::kRefused, {refusal_text(set, report)}, {set.spec().name}};
  const Task& task = set.tasks()[report.task.index];
  return Error{ErrorCode::kRefused, {std::string("init: ") + task.faults.last.text}, {task.spec->name}};
}

}  // namespace chimera
