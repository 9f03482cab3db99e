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
  const std::string_view name = task.spec->name, signal = signal_name(report.signal);
  const auto put_all = [&put](auto... parts) { (put(std::string_view(parts)), ...); };
  if (report.why == Refusal::kFault) return put_all(signal, ": ", name, ": ", task.faults.last.text);
  if (report.why == Refusal::kNotYet) return put_all(signal, ": ", name, " is not ready yet");
  if (const TaskId rival = judge.find_rival(report.task); report.why == Refusal::kRival && rival.is_valid())
    return put_all(name, " has the resource '", judge.rivals().resource(report.task, rival), "' of ",
                   set.spec().tasks[rival.index].name, ", which is created");
  put_all(signal, " is not legal for ", name, " in state ", state_name(report.before));
}

}  // namespace chimera
