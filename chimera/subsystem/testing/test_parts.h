// SPDX-License-Identifier: Apache-2.0
// For tests: the parts of a Subsystem, each called by the test, on the application of TestWorld. All tasks are OFF and
// both rtpus serve, unless the test changes that.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/on_transaction.h"
#include "chimera/subsystem/testing/test_world.h"

namespace chimera::subsystem {

class TestParts : public TestWorld {
 public:
  explicit TestParts(bool spare_serves = true) {
    state.now = state.complete_since = now;
    state.is_complete = true;
    state.actions = &actions;
    for (TaskId task : {kArm, kPid, kTraj, kReserve}) is(task, State::kOff);
    state.observed.up(kServo, 1);
    if (spare_serves) state.observed.up(kSpare, 1);
  }

  /// The status word of the task is read.
  void is(TaskId task, State seen, bool in_service = false) { state.observed.see(task, {seen, in_service, 1}); }
  void are_on(const std::vector<TaskId>& tasks) {
    for (TaskId task : tasks) is(task, State::kOn);
  }
  /// The requests since the last call, one a line.
  std::string taken() { return lines(std::exchange(actions, {})); }
  /// The task goes to `after`, and its rtpu reports on the last signal for it.
  SignalResult reported(TaskId task, State after, SignalRefusal why = {}) {
    const Reported last = sent[task.index];
    const State before = state.observed.state(task);
    (void)state.pending.settle(task, last.command);
    is(task, after);
    return {last.command, task, last.signal, before, after, std::move(why)};
  }
  void pass(Nanoseconds time) { state.now += time; }

  /// "2 s: " and the requests of the queue at the time for which it waits. "too early" marks requests before that time.
  template <class Queue>
  std::string waits(Queue& queue) {
    const Nanoseconds due = queue.next_due();
    const std::string said = std::to_string((due - state.now).count / 1'000'000'000) + " s: ";
    state.now = due - Nanoseconds{1};
    (void)queue.advance();
    const std::string early = taken();
    state.now = due;
    (void)queue.advance();
    const std::string asked = taken();
    return said + (early.empty() ? "" : "too early: " + early) + asked + (queue.next_due() == kNever ? "" : "again\n");
  }

  std::vector<Action> actions;
  SubsystemState state{spec};
  Goals goals{state};
  OnTransaction transaction{state, goals};
};

}  // namespace chimera::subsystem
