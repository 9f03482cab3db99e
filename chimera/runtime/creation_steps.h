// SPDX-License-Identifier: Apache-2.0
// The steps of a slow switch that create tasks and take them away again, spawn and kill, as one context carries them
// out: over several edges where a service thread runs `init` and `kill`. Remembers which it has done, so that those
// alone are undone.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/task/signal.h"
#include "chimera/task/state_machine.h"
#include "chimera/task/task.h"

namespace chimera {

/// How far a step is.
enum class StepEnd : std::uint8_t { kDone, kWaits, kFailed };

/// Context of everything not marked: cycle boundary; wait-free. The methods themselves are called by `Move`, which is
/// given the task and the signal.
class CreationSteps {
 public:
  /// Context: setup.
  void prepare(std::size_t n_tasks, SetupMemory& memory);
  /// Of another switch: nothing is done.
  void begin() noexcept;
  /// The task is handed over to the service thread by one of these steps.
  bool is_under_way(TaskId task) const noexcept { return asked_ == task; }

  /// `signal` is kSpawn or kKill. Done at once where there is nothing to do. kFailed: nothing is to be undone.
  template <class Move>
  StepEnd carry_out(Task& task, Signal signal, Move move) {
    if (asked_ != task.id && task.state == after(signal)) return StepEnd::kDone;
    if (const StepEnd end = go_on(task, signal, move); end != StepEnd::kDone) return end;
    if (task.state != after(signal)) return StepEnd::kFailed;
    mark(task.id, signal, true);
    return StepEnd::kDone;
  }
  /// Takes the step back that was carried out here; kDone also where the other method failed.
  template <class Move>
  StepEnd undo(Task& task, Signal signal, Move move) {
    if (!is_done(task.id, signal)) return StepEnd::kDone;
    const Signal back = signal == Signal::kSpawn ? Signal::kKill : Signal::kSpawn;
    if (asked_ != task.id && next(task.state, back, false).kind == Next::Kind::kImpossible) return StepEnd::kDone;
    if (go_on(task, back, move) == StepEnd::kWaits) return StepEnd::kWaits;
    mark(task.id, signal, false);
    return StepEnd::kDone;
  }
  /// The switch was aborted while the step was under way. kDone: it is to be undone. kFailed: it had not begun.
  StepEnd cut(const Task& task, Signal signal) noexcept;

 private:
  static State after(Signal signal) noexcept { return signal == Signal::kSpawn ? State::kOff : State::kNotCreated; }
  template <class Move>
  StepEnd go_on(Task& task, Signal signal, Move move) {
    if (asked_ != task.id) {
      asked_ = task.id;
      move(task, signal);
    }
    if (task.in_service) return StepEnd::kWaits;
    asked_ = TaskId();
    return StepEnd::kDone;
  }
  bool is_done(TaskId task, Signal signal) const noexcept { return of(signal)[task.index]; }
  void mark(TaskId task, Signal signal, bool is_done) noexcept { of(signal)[task.index] = is_done; }
  std::span<bool> of(Signal signal) const noexcept { return signal == Signal::kSpawn ? spawned_ : killed_; }

  std::span<bool> spawned_, killed_;  // by task
  TaskId asked_;
};

}  // namespace chimera
