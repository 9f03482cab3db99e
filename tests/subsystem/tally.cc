// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/tally.h"

namespace chimera::simulated {
namespace {

constexpr const char* kStepNames[kSteps] = {"init",   "kill-after-init", "on",           "sync",  "cycle",
                                            "off",    "off-then-kill",   "kill",         "reinit-in-off",
                                            "reinit-in-on", "clear",     "error-to-off", "error-to-on"};
constexpr const char* kAnswerNames[kAnswers] = {"ok", "fault", "no-event", "aborted", "not-yet"};

std::string signal_key(State state, Signal signal, bool aperiodic) {
  return std::string("signal ") + state_name(state) + " " + signal_name(signal) + (aperiodic ? " aperiodic" : "");
}

std::string answer_key(Step step, Answer answer) {
  return std::string("step ") + kStepNames[static_cast<int>(step)] + " " + kAnswerNames[static_cast<int>(answer)];
}

/// Fault points and ends that the simulation must reach, as it names them.
constexpr const char* kRequired[] = {
    "action send", "action start", "action goal", "action handled", "action restart", "action started",
    "action answer yes", "action answer no", "action tell",
    "tell started", "tell signal", "tell refused", "tell fault",
    "tell rtpu-ended", "tell rtpu-restarted", "tell rtpu-given-up",
    "death starting", "death idle", "death before a step", "death after a step", "death inside a list",
    "death in a transaction", "death in a rollback", "death before a report", "death after a report",
    "death with work in service", "death without a manager", "death of a hung one", "death of a crasher",
    "stall", "hang idle", "hang in a method", "hang in a transaction",
    "manager death at the first action", "manager death between actions", "manager death after the last action",
    "manager death idle", "manager death in the inventory", "manager death in a transaction",
    "manager death in a restart", "manager and rtpu dead together",
    "command again", "command answered yes", "command answered no", "no answer", "transaction rolled back",
    "revived by spawn", "revived by clear", "killed while dead", "posts of a dead manager dropped",
    "signal between tasks", "request for on", "flag up", "flag down"};

}  // namespace

void Tally::count_signal(State state, Signal signal, bool aperiodic) {
  const bool matters = signal == Signal::kWakeup && state == State::kOn && aperiodic;
  count(signal_key(state, signal, matters));
}

void Tally::count_answer(Step step, Answer answer) { count(answer_key(step, answer)); }

std::vector<std::string> Tally::missing() const {
  std::vector<std::string> names;
  const auto need = [&](const std::string& what) {
    if (of(what) == 0) names.push_back(what);
  };
  for (int s = 0; s < kSteps; ++s)
    for (int a = 0; a < kAnswers; ++a)
      if (rule(static_cast<Step>(s)).next[a].kind != Next::Kind::kImpossible)
        need(answer_key(static_cast<Step>(s), static_cast<Answer>(a)));
  for (int state = 0; state < kStates; ++state)
    for (std::uint32_t signal = 0; signal < CHIMERA_SIGNAL_WAKEUP; ++signal)
      if (signal != CHIMERA_SIGNAL_ON || static_cast<State>(state) == State::kOff)  // other states never receive `on`
        need(signal_key(static_cast<State>(state), static_cast<Signal>(signal), false));
  need(signal_key(State::kOn, Signal::kWakeup, false));
  need(signal_key(State::kOn, Signal::kWakeup, true));
  for (const char* what : kRequired) need(what);
  return names;
}

}  // namespace chimera::simulated
