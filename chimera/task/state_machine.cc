// SPDX-License-Identifier: Apache-2.0
// The table of transitions of a task, and functions that read it.
#include "chimera/task/state_machine.h"

namespace chimera {
namespace {

constexpr Next kNo{};
constexpr Next to(Step step) { return {Next::Kind::kStep, step, State::kNotCreated}; }
constexpr Next to(State state) { return {Next::Kind::kState, Step::kInit, state}; }

constexpr State kNot = State::kNotCreated, kOff = State::kOff, kOn = State::kOn, kErr = State::kError;

// Answers in the order of Answer: ok, fault, no event, aborted, not yet.
constexpr StepRule kRules[kSteps] = {
    {Step::kInit, Method::kInit, kReadConst, kWriteConst, {to(kOff), to(Step::kKillAfterInit), kNo, kNo, kNo}},
    {Step::kKillAfterInit, Method::kKill, kNoTransfer, kNoTransfer, {to(kNot), to(kNot), kNo, kNo, kNo}},
    {Step::kOn, Method::kOn, kReadIn | kReadOut, kWriteOut, {to(kOn), to(Step::kErrorToOff), kNo, kNo, to(kOff)}},
    {Step::kSync, Method::kSync, kNoTransfer, kNoTransfer, {to(Step::kCycle), to(Step::kErrorToOn), to(kOn), kNo, kNo}},
    {Step::kCycle, Method::kCycle, kReadIn, kWriteOut, {to(kOn), to(Step::kErrorToOn), kNo, to(kOn), kNo}},
    {Step::kOff, Method::kOff, kReadIn, kWriteOut, {to(kOff), to(Step::kErrorToOff), kNo, kNo, kNo}},
    {Step::kOffThenKill, Method::kOff, kReadIn, kWriteOut, {to(Step::kKill), to(Step::kKill), kNo, kNo, kNo}},
    {Step::kKill, Method::kKill, kNoTransfer, kNoTransfer, {to(kNot), to(kNot), kNo, kNo, kNo}},
    {Step::kReinitInOff, Method::kReinit, kReadConst, kWriteConst, {to(kOff), to(Step::kErrorToOff), kNo, kNo, kNo}},
    {Step::kReinitInOn, Method::kReinit, kReadConst, kWriteConst, {to(kOn), to(Step::kErrorToOn), kNo, kNo, kNo}},
    {Step::kClear, Method::kClear, kReadIn, kWriteOut, {to(kOff), to(kErr), kNo, kNo, kNo}},
    {Step::kErrorToOff, Method::kError, kReadIn, kWriteOut, {to(kOff), to(kErr), kNo, kNo, kNo}},
    {Step::kErrorToOn, Method::kError, kReadIn, kWriteOut, {to(kOn), to(kErr), kNo, kNo, kNo}},
};

constexpr bool rules_stand_in_order() {
  for (int i = 0; i < kSteps; ++i)
    if (kRules[i].step != static_cast<Step>(i)) return false;
  return true;
}
static_assert(rules_stand_in_order());

// Signals by state: spawn, on, off, kill, clear, reinit, wakeup.
constexpr Next kSignals[kStates][CHIMERA_SIGNALS] = {
    /* NOT-CREATED */ {to(Step::kInit), kNo, kNo, kNo, kNo, kNo, to(kNot)},
    /* OFF   */ {kNo, to(Step::kOn), kNo, to(Step::kKill), kNo, to(Step::kReinitInOff), to(kOff)},
    /* ON    */ {kNo, kNo, to(Step::kOff), to(Step::kOffThenKill), kNo, to(Step::kReinitInOn), to(Step::kCycle)},
    /* ERROR */ {kNo, kNo, kNo, to(Step::kKill), to(Step::kClear), kNo, to(kErr)},
};

}  // namespace

const StepRule& rule(Step step) noexcept { return kRules[static_cast<int>(step)]; }

Next next(State state, Signal signal, bool aperiodic) noexcept {
  const Next found = kSignals[static_cast<int>(state)][static_cast<int>(signal)];
  const bool woken = state == State::kOn && signal == Signal::kWakeup;
  return woken && aperiodic ? to(Step::kSync) : found;
}

Answer answer_of(Method method, std::int32_t value) noexcept {
  if (value == CHIMERA_OK) return Answer::kOk;
  if (value == CHIMERA_NO_EVENT && method == Method::kSync) return Answer::kNoEvent;
  if (value == CHIMERA_ABORTED && method == Method::kCycle) return Answer::kAborted;
  if (value == CHIMERA_NOT_YET && method == Method::kOn) return Answer::kNotYet;
  return Answer::kFault;
}

bool has_arrived(Signal signal, State before, State after) noexcept {
  switch (signal) {
    case Signal::kSpawn:
    case Signal::kOff:
    case Signal::kClear: return after == State::kOff;
    case Signal::kOn: return after == State::kOn;
    case Signal::kKill: return after == State::kNotCreated;
    default: return after == before;
  }
}

const char* state_name(State state) noexcept {
  constexpr const char* kNames[kStates] = {"NOT-CREATED", "OFF", "ON", "ERROR"};
  return kNames[static_cast<int>(state)];
}

}  // namespace chimera
