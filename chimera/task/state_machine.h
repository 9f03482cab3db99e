// SPDX-License-Identifier: Apache-2.0
// The life of a task: four states, nine methods, and every transition between them in one table.
// 1994 paper figure 7, 2000 paper figure 6. The papers leave open what follows a fault in each method and what an
// unexpected signal does; the table decides it:
// - A fault in `init` kills the task. A fault in `kill` leaves NOT-CREATED and is reported as a leak.
// - After a fault in `off` the outputs of the last cycle stand, and the task never returns to ON.
// - `kill` is legal while ON (`off` first) and in ERROR, so a task that cannot be repaired can be ended.
// - After `clear` the task is OFF: a person decides when it goes ON. A signal that is not legal changes nothing.
// - `off` reads its inputs first: it leaves a machine safe, so it must see where the machine is now.
//
// A signal starts a chain of steps. A step is one method with its transfers. The answer of the method leads to the next
// step or to a state. No other event moves a task.
#pragma once

#include <cstdint>
#include "chimera/task/abi.h"
#include "chimera/task/signal.h"

namespace chimera {

enum class State : std::uint8_t { kNotCreated, kOff, kOn, kError };
inline constexpr int kStates = 4;

/// Where a task stands beside its state. At most one value holds: a signal first ends the standing that it finds.
enum class Standing : std::uint8_t {
  kPlain,      ///< the state says all
  kInService,  ///< not ON: the service thread runs `init` or `kill`, and no other thread uses the task
  kHalfOn,     ///< not ON: `on` answered "not yet", and `off` must run unless `on` continues
  kOwesOff,    ///< OFF, after `on` and before `off`: armed for a switch, or left by a switch
  kWarm        ///< ON: a hot standby, which cycles without readers and counts as OFF for all other tasks
};

enum class Answer : std::uint8_t {
  kOk = CHIMERA_OK, kFault = CHIMERA_FAULT, kNoEvent = CHIMERA_NO_EVENT, kAborted = CHIMERA_ABORTED, kNotYet = 4
};
inline constexpr int kAnswers = 5;

/// The data copied around a method. In the notation of the papers: `>x` global to local, `x>` local to global.
enum Transfer : std::uint8_t {
  kNoTransfer = 0,
  kReadConst = 1 << 0,   ///< >in-const
  kWriteConst = 1 << 1,  ///< out-const>
  kReadIn = 1 << 2,      ///< >in-var
  kReadOut = 1 << 3,     ///< >out-var: the last value of a predecessor
  kWriteOut = 1 << 4     ///< out-var>
};

/// One method at its place in a transition. A method at two places is two steps.
enum class Step : std::uint8_t {
  kInit, kKillAfterInit, kOn, kSync, kCycle, kOff, kOffThenKill, kKill, kReinitInOff, kReinitInOn, kClear,
  kErrorToOff, kErrorToOn
};
inline constexpr int kSteps = 13;

/// The result of an answer: another step, a state, or none, because the answer is impossible there.
struct Next {
  enum class Kind : std::uint8_t { kImpossible, kStep, kState };
  Kind kind = Kind::kImpossible;
  Step step = Step::kInit;
  State state = State::kNotCreated;
};

struct StepRule {
  Step step;
  Method method;
  std::uint8_t before;          ///< Transfer bits before the method
  std::uint8_t after_ok;        ///< Transfer bits after kOk; any other answer publishes nothing
  Next next[kAnswers];          ///< by Answer
};

/// The rule of `step`. Context: any; wait-free.
const StepRule& rule(Step step) noexcept;

/// The effect of `signal` in `state`: a step, the same state (an ignored wakeup), or kImpossible: the signal is
/// illegal, and the refusal names both. `aperiodic`: a wakeup calls sync first. Context: any; wait-free.
Next next(State state, Signal signal, bool aperiodic) noexcept;

/// Interprets the answer of a method. An answer that the method may not give is a fault. Context: any; wait-free.
Answer answer_of(Method method, std::int32_t value) noexcept;

/// True if `signal`, sent in state `before`, has reached its goal in state `after`. spawn, off and clear lead to OFF,
/// on to ON, kill to NOT-CREATED. Any other signal leaves the state as it was. Context: any; wait-free.
bool has_arrived(Signal signal, State before, State after) noexcept;

/// The name of a state in commands, JSON and messages: "NOT-CREATED". Context: any; wait-free.
const char* state_name(State state) noexcept;

}  // namespace chimera
