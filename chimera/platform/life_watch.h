// SPDX-License-Identifier: Apache-2.0
// Judges from samples whether the loop of another process still runs. A pure function of the samples: reads no clock
// and makes no system call. docs/formats/processes.md, "Who watches whom".
#pragma once

#include <cstdint>
#include <string>

#include "chimera/platform/process_state.h"

namespace chimera {

/// How a process does.
enum class Life : std::uint8_t {
  kRuns,
  kStopped,  ///< stopped by a signal
  kTraced,   ///< held by a debugger at the last sample
  kWaits,    ///< in a system call that does not return
  kLoops,    ///< no beat, but processor use for half of the silence, or for half of LifeLimits::told
  kStarves,  ///< gets no processor
  kSpins     ///< beats, but uses a whole processor although it should wait
};

struct LifeSample {
  Nanoseconds at;
  std::uint64_t beats = 0;  ///< grows once in each round of the loop
  ProcessState process;
};

struct LifeVerdict {
  Life life = Life::kRuns;
  Nanoseconds silent;  ///< time without a beat while the watch ran; at the first new beat, the silence before it
  char letter = 0;     ///< ProcessState::letter
  pid_t tracer = 0;
  bool is_news = false;  ///< report this verdict now: the process hangs, still hangs, or runs again
  bool is_over = false;  ///< the patience is used up: end the process

  /// "stopped by a signal (state T)", "held by a debugger (pid 4711)", "in a system call that does not return (state
  /// S)", "in a loop that does not end (state R)", "gets no processor (state R)", "uses a whole processor".
  std::string text() const;
};

/// How long a process may be silent.
struct LifeLimits {
  Nanoseconds told = milliseconds(1500);  ///< silence before a report; with the sample period less than 2 s. A lower
                                          ///< limit would report on every loaded machine
  Nanoseconds patience = seconds(3);      ///< silence before is_over
  Nanoseconds spins = kNever;             ///< use of a whole processor before a report; kNever: allowed
};
/// True if a report is due again between the two times of silence: at 10 s, 60 s, 600 s, 1200 s ... Pure.
bool is_told_again(Nanoseconds before, Nanoseconds now) noexcept;
/// After a longer time between two samples the watch itself did not run: that time does not count as silence.
inline constexpr Nanoseconds kWatchGap = seconds(1);

/// The watch of one process. A new process needs a new watch.
class LifeWatch {
 public:
  /// Judges a sample. Samples come in the order of time, a few in each second. A process that a debugger holds, or that
  /// gets no processor, is never over. Context: setup.
  LifeVerdict look(const LifeSample& sample, const LifeLimits& limits) noexcept;

 private:
  Life life_of(const LifeSample& sample, Nanoseconds told) const noexcept;
  bool spins(const LifeSample& sample, Nanoseconds window) noexcept;

  bool has_begun_ = false, is_told_ = false, is_spinning_ = false;
  Nanoseconds window_, window_used_;  // time and processor use at the begin of the present window for kSpins
  Nanoseconds last_, silent_;         // time of the last sample, and the silence at that time
  Nanoseconds used_;                  // processor use at the last beat
  std::uint64_t beats_ = 0;
};

}  // namespace chimera
