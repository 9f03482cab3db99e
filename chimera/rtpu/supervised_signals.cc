// SPDX-License-Identifier: Apache-2.0
// Shows the supervising thread the method that a signal has called, while it runs.
#include "chimera/rtpu/supervised_signals.h"

#include "chimera/runtime/task_word.h"

namespace chimera {
namespace {

// The first method that a signal calls.
Method method_of(Signal signal) noexcept {
  switch (signal) {
    case Signal::kSpawn:
      return Method::kInit;
    case Signal::kOn:
      return Method::kOn;
    case Signal::kOff:
      return Method::kOff;
    case Signal::kKill:
      return Method::kKill;
    case Signal::kClear:
      return Method::kClear;
    case Signal::kReinit:
      return Method::kReinit;
    default:
      return Method::kCycle;
  }
}

}  // namespace

SignalReport SupervisedSignals::carry_out(BoundarySignals& signals, std::span<const TaskId> tasks, Signal signal,
                                          Nanoseconds now) noexcept {
  acting_ = TaskWord(tasks[0], method_of(signal)).word();
  ++progress_;
  const SignalReport done = signals.signal(tasks, signal, now);
  others_.publish(tasks_);
  acting_ = 0;
  ++progress_;
  return done;
}

}  // namespace chimera
