// SPDX-License-Identifier: Apache-2.0
// Judges samples of a process: the silence of its loop, and the reason, from its state in the kernel.
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

// An endless loop shows in the processor use, even if other processes share the processor.
Life LifeWatch::life_of(const LifeSample& sample, Nanoseconds told) const noexcept {
  const ProcessState& process = sample.process;
  const Nanoseconds used = process.used - used_;
  if (process.tracer != 0) return Life::kTraced;
  if (process.letter == 'T' || process.letter == 't') return Life::kStopped;
  const bool would_run = process.letter == 'R';
  if (used * 2 > silent_ || (would_run && used * 2 >= told)) return Life::kLoops;
  return would_run ? Life::kStarves : Life::kWaits;
}

// True if the process used nine tenths of a whole window.
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
  const bool came_round = !has_begun_ || sample.beats != beats_;
  const Nanoseconds silent_before = silent_, since_last = sample.at - last_;
  if (has_begun_ && since_last <= kWatchGap) silent_ = silent_ + since_last;
  verdict.silent = silent_;
  has_begun_ = true;
  last_ = sample.at;
  beats_ = sample.beats;
  if (came_round) {
    silent_ = {};
    used_ = sample.process.used;
    const bool was_told = is_told_, spun = is_spinning_;
    is_told_ = false;
    is_spinning_ = limits.spins != kNever && spins(sample, limits.spins);
    if (is_spinning_) verdict.life = Life::kSpins;
    verdict.is_news = was_told || spun != is_spinning_;
    return verdict;
  }
  if (silent_ < limits.told) return verdict;
  verdict.life = life_of(sample, limits.told);
  verdict.is_news = !is_told_ || is_told_again(silent_before, silent_);
  is_told_ = true;
  verdict.is_over = silent_ >= limits.patience && verdict.life != Life::kTraced && verdict.life != Life::kStarves;
  return verdict;
}

}  // namespace chimera
