// SPDX-License-Identifier: Apache-2.0
// For tests: applications of toys and scripts that a seed decides, and what came of them as texts.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "chimera/runtime/cycle/script.h"
#include "chimera/runtime/record/tap_record.h"
#include "tests/conformance/toy.h"

namespace chimera::toy {

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_()) % n; }

 private:
  std::mt19937 engine_;
};

/// Anything that a description may say, overload included.
inline void fill(Application& app, Dice& dice) {
  constexpr OnMiss kReactions[] = {OnMiss::kContinue, OnMiss::kHold, OnMiss::kSkip, OnMiss::kAbort,
                                   OnMiss::kError,    OnMiss::kFlag};
  const std::uint32_t n = 1 + dice.below(8);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::string name = "t" + std::to_string(i);
    const std::string reads = i > 0 && dice.below(2) == 0 ? "t" + std::to_string(dice.below(i)) : "";
    TaskSpec& spec = app.add(name, milliseconds(1 + dice.below(9)), microseconds(50 + dice.below(900)), reads);
    spec.offset = milliseconds(dice.below(3));
    if (dice.below(3) == 0) spec.deadline = microseconds(500);
    spec.criticality = dice.below(3);
    spec.user_priority = dice.below(3);
    spec.budget = microseconds(300 + dice.below(700));
    spec.on_miss = kReactions[dice.below(6)];
    spec.on_overrun = kReactions[dice.below(6)];
    if (dice.below(4) == 0) spec.min_time = microseconds(200);
    if (dice.below(4) == 0) spec.max_consecutive = 1 + dice.below(4);
    spec.aperiodic = dice.below(4) == 0;
    for (std::uint32_t k = 0; k < 20; ++k) {
      app.toy(name).answers[CHIMERA_SYNC].push_back(dice.below(2) == 0 ? CHIMERA_OK : CHIMERA_NO_EVENT);
      app.toy(name).answers[CHIMERA_ERROR].push_back(dice.below(2) == 0 ? CHIMERA_OK : CHIMERA_FAULT);
      const auto signal = dice.below(2) == 0 ? Signal::kOff : Signal::kOn;
      app.toy(name).sends.emplace_back(signal, dice.below(4) == 0 ? "t" + std::to_string(dice.below(i + 1)) : "");
    }
  }
}

inline std::vector<ScriptAct> script(Dice& dice, std::uint32_t n) {
  std::vector<ScriptAct> acts;
  Nanoseconds at;
  for (int i = 0; i < 12; ++i) {
    at += microseconds(dice.below(6000));
    const std::uint32_t what = dice.below(6);
    constexpr Signal kSignals[] = {Signal::kOn, Signal::kOff, Signal::kClear, Signal::kReinit};
    if (what < 4) acts.push_back({at, ScriptAct::Kind::kSignal, kSignals[what], TaskId(dice.below(n))});
    else acts.push_back({at, what == 4 ? ScriptAct::Kind::kRaiseFlag : ScriptAct::Kind::kLowerFlag, {}, TaskId()});
  }
  return acts;
}

/// Gives some tasks events, and lets tasks and the script ring. After fill() and script(); n: number of tasks.
inline void add_events(Application& app, std::vector<ScriptAct>& acts, Dice dice, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::string name = "t" + std::to_string(i);
    if (dice.below(2) == 0) app.spec(name).aperiodic = app.spec(name).has_events = true;
    auto& sends = app.toy(name).sends;
    for (std::uint32_t k = 0; k < 20; ++k)
      sends.emplace(sends.begin() + dice.below(20), Signal::kWakeup, "t" + std::to_string(dice.below(n)));
  }
  Nanoseconds at;
  for (std::uint32_t k = 0; k < 30; ++k) {
    if (dice.below(3) > 0) at += microseconds(dice.below(3000));
    acts.push_back({at, ScriptAct::Kind::kSignal, Signal::kWakeup, TaskId(dice.below(n))});
  }
  std::stable_sort(acts.begin(), acts.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
}

inline std::string text(const TapRecord& r) {
  return "kind " + std::to_string(static_cast<int>(r.kind)) + " task " + std::to_string(r.task.index) + " at " +
         std::to_string(r.at.count) + " a " + std::to_string(r.a) + " b " + std::to_string(r.b);
}

inline std::string text(const Call& c) {
  return c.task + " " + method_name(c.method) + " " + std::to_string(c.now.count) + " " + std::to_string(c.in) + " " +
         std::to_string(c.dropped) + " " + std::to_string(c.inherited) + (c.illegal ? " illegal" : "");
}

}  // namespace chimera::toy
