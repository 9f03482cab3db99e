// SPDX-License-Identifier: Apache-2.0
// Says in words why a signal was refused, without a heap: `put` receives the text piece by piece. A host adds the
// smallest legal set (runtime/hosted/refusal_text.h).
#pragma once

#include <string_view>

#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/set_words.h"

namespace chimera {

/// The reason of a refused report; nothing when the report was accepted. For a report of the last call of
/// TaskLife::signal(). `put(std::string_view)` receives the pieces in order. Context: cycle boundary; O(ports), and
/// what `put` takes.
template <class Put>
void put_refusal(TaskSet& set, const SignalReport& report, Put put) {
  if (report.is_accepted) return;
  const SignalJudge& judge = set.life().judge();
  if (report.why == Refusal::kIllegalSet)
    return put_set_fault(set.spec().variables, judge.wanted(), set.spec().tasks, put);
  const Task& task = set.tasks()[report.task.index];
  // A digit of the form is a gap for a value. In an image this takes less memory than a call for each part.
  std::string_view values[4] = {signal_name(report.signal), task.spec->name};
  const char* form = "0 is not legal for 1 in state 2";
  if (report.why == Refusal::kFault) {
    form = "0: 1: 2";
    values[2] = task.faults.last.text;
  } else if (report.why == Refusal::kNotYet) {
    form = "0: 1 is not ready yet";
  } else if (const TaskId rival = judge.find_rival(report.task); report.why == Refusal::kRival && rival.is_valid()) {
    form = "1 has the resource '2' of 3, which is created";
    values[2] = judge.rivals().resource(report.task, rival);
    values[3] = set.spec().tasks[rival.index].name;
  } else {
    values[2] = state_name(report.before);
  }
  for (; *form != '\0'; ++form) put(*form >= '0' && *form <= '3' ? values[*form - '0'] : std::string_view(form, 1));
}

}  // namespace chimera
