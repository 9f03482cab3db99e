// SPDX-License-Identifier: Apache-2.0
// Whether another process still goes round its loop, judged from samples by whoever watches it. Knows no clock and
// asks nobody: samples in, verdicts out. docs/formats/processes.md, "Who watches whom".
#pragma once

#include <cstdint>
#include <string>

#include "chimera/platform/process_state.h"

namespace chimera {

/// What is the matter with a process.
enum class Life : std::uint8_t {
  kRuns,
  kStopped,  ///< by a signal
  kTraced,   ///< a debugger holds it, or looked at it when it was last seen
  kWaits,    ///< in a system call that does not return
  kLoops,    ///< has not come round, and used the processor half of that time, or half of LifeLimits::told
  kStarves,  ///< gets no processor
  kSpins     ///< comes round, and uses a processor whole although it should wait
};

struct LifeSample {
  Nanoseconds at;
  std::uint64_t beats = 0;  ///< grows each time that its loop comes round
  ProcessState process;
};

struct LifeVerdict {
  Life life = Life::kRuns;
  Nanoseconds silent;  ///< how long it has not come round while the watch ran, or had not when it did again
  char letter = 0;     ///< ProcessState::letter
  pid_t tracer = 0;
  bool is_news = false;  ///< to be told now: it hangs, it still hangs, or it runs again
  bool is_over = false;  ///< no more patience with it: to be ended

  /// "stopped by a signal (state T)", "held by a debugger (pid 4711)", "in a system call that does not return (state
  /// S)", "in a loop that does not end (state R)", "gets no processor (state R)", "uses a whole processor".
  std::string text() const;
};

/// How long one may be silent.
struct LifeLimits {
  Nanoseconds told = milliseconds(1500);  ///< until that is told: with the time between samples less than 2 s
  Nanoseconds patience = seconds(3);      ///< until it is ended
  Nanoseconds spins = kNever;             ///< until one that uses a processor whole is told; kNever: it may
};
/// When what goes on is told again: 10 s, 60 s, 600 s, 1200 s ... Pure.
bool is_told_again(Nanoseconds before, Nanoseconds now) noexcept;
/// Longer between two samples, and the watch itself did not run: that time counts as silence of nobody.
inline constexpr Nanoseconds kWatchGap = seconds(1);

/// Of one process; another one begins with another watch.
class LifeWatch {
 public:
  /// Samples come in the order of time, a few in each second. One that a debugger holds, and one that gets no
  /// processor, is never over. Context: setup.
  LifeVerdict look(const LifeSample& sample, const LifeLimits& limits) noexcept;

 private:
  Life life_of(const LifeSample& sample, Nanoseconds told) const noexcept;
  bool spins(const LifeSample& sample, Nanoseconds window) noexcept;

  bool has_begun_ = false, is_told_ = false, is_spinning_ = false;
  Nanoseconds window_, window_used_;  // where the present look at its load began
  Nanoseconds last_, silent_;  // the last sample; for how long its loop had not come round then
  Nanoseconds used_;           // what it had used when its loop came round
  std::uint64_t beats_ = 0;
};

}  // namespace chimera
