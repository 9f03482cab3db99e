// SPDX-License-Identifier: Apache-2.0
// Judges samples of a process: how long its loop is silent, and from its state in the kernel why.
#include "chimera/platform/life_watch.h"

namespace chimera {

std::string LifeVerdict::text() const {
  const std::string state = std::string(" (state ") + (letter == 0 ? '?' : letter) + ")";
  switch (life) {
    case Life::kStopped:
      return "stopped by a signal" + state;
    case Life::kTraced:
      return "held by a debugger (pid " + std::to_string(tracer) + ")";
    case Life::kWaits:
      return "in a system call that does not return" + state;
    case Life::kLoops:
      return "in a loop that does not end" + state;
    case Life::kStarves:
      return "gets no processor" + state;
    case Life::kSpins:
      return "uses a whole processor";
    case Life::kRuns:
      break;
  }
  return "runs";
}

bool is_told_again(Nanoseconds before, Nanoseconds now) noexcept {
  for (const Nanoseconds mark : {seconds(10), seconds(60)})
    if (before < mark && now >= mark) return true;
  return before.count / seconds(600).count != now.count / seconds(600).count;
}

Life LifeWatch::life_of(const LifeSample& sample, Nanoseconds silent) const noexcept {
  const ProcessState& process = sample.process;
  if (process.tracer != 0) return Life::kTraced;
  if (process.letter == 'T' || process.letter == 't') return Life::kStopped;
  if ((process.used - used_) * 2 > silent) return Life::kLoops;
  return process.letter == 'R' ? Life::kStarves : Life::kWaits;
}

// Nine tenths of a whole window.
bool LifeWatch::spins(const LifeSample& sample, Nanoseconds window) noexcept {
  const Nanoseconds time = sample.at - window_, used = sample.process.used - window_used_;
  if (time < window) return is_spinning_;
  window_ = sample.at;
  window_used_ = sample.process.used;
  return time < window + kWatchGap && used * 10 >= time * 9;
}

LifeVerdict LifeWatch::look(const LifeSample& sample, const LifeLimits& limits) noexcept {
  LifeVerdict verdict;
  verdict.letter = sample.process.letter;
  verdict.tracer = sample.process.tracer;
  const bool was_away = has_begun_ && sample.at - last_ > kWatchGap;
  const bool came_round = !has_begun_ || sample.beats != beats_;
  const Nanoseconds silent_before = last_ - since_;
  verdict.silent = sample.at - since_;
  has_begun_ = true;
  last_ = sample.at;
  beats_ = sample.beats;
  if (came_round || was_away) {
    verdict.is_news = is_told_ && came_round;
    is_told_ = is_told_ && !came_round;
    since_ = sample.at;
    used_ = sample.process.used;
    if (came_round) {
      const bool spun = is_spinning_;
      is_spinning_ = limits.spins != kNever && spins(sample, limits.spins);
      if (is_spinning_) verdict.life = Life::kSpins;
      verdict.is_news = verdict.is_news || spun != is_spinning_;
      return verdict;
    }
    verdict.silent = {};
  }
  if (verdict.silent < limits.told) return verdict;
  verdict.life = life_of(sample, verdict.silent);
  verdict.is_news = !is_told_ || is_told_again(silent_before, verdict.silent);
  is_told_ = true;
  verdict.is_over =
      verdict.silent >= limits.patience && verdict.life != Life::kTraced && verdict.life != Life::kStarves;
  return verdict;
}

}  // namespace chimera
