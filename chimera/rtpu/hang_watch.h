// SPDX-License-Identifier: Apache-2.0
// Judges from counters whether the loop or a method of the rtpu hangs. The main thread calls it, because no method can
// delay that thread.
#pragma once

#include <cstdint>

#include "chimera/runtime/job/hang_rule.h"

namespace chimera {

/// Only the main thread uses it. It remembers the last values and since when they have not changed.
class HangWatch {
 public:
  /// `method_limit`: longest time of one method.
  explicit HangWatch(Nanoseconds method_limit) noexcept : limit_(method_limit) {}

  /// True if the loop has been in one method for longer than the limit: no cycle boundary comes then. `running` is the
  /// method (BlockHead::running; 0: the loop waits); `beats` grows with each cycle boundary and each job that has
  /// ended. Context: main thread; wait-free.
  bool loop_hangs(std::uint32_t running, std::uint64_t beats, Nanoseconds now) noexcept {
    return loop_.look(running, beats, running == 0, now) > limit_;
  }

  /// As loop_hangs() for a cycle of `task`, by the rule of all executors. `thread_used`: execution time of the thread
  /// of the loop. Context: main thread; wait-free.
  bool job_hangs(const TaskSpec& task, std::uint32_t running, std::uint64_t beats, Nanoseconds thread_used,
                 Nanoseconds now) noexcept {
    const Nanoseconds used = use_.look(running, beats, false, thread_used);
    job_used_ = used > most_use(task) ? used : Nanoseconds{};
    return hangs(task, used, loop_.look(running, beats, false, now) - used);
  }
  /// Execution time that the job used at least, if it hangs because of it; else zero. Context: main thread.
  Nanoseconds job_used() const noexcept { return job_used_; }

  /// True if a method that a cycle boundary or the service thread called has run for longer than the limit. `method` is
  /// that method (0: none); `progress` grows when a method begins or ends. Context: main thread; wait-free.
  bool method_hangs(std::uint32_t method, std::uint32_t progress, Nanoseconds now) noexcept {
    return method_.look(method, progress, method == 0, now) > limit_;
  }

  /// Longest time of one method.
  Nanoseconds limit() const noexcept { return limit_; }

  /// The rtpu ends from here on. Context: main thread; wait-free.
  void begin_end(Nanoseconds now) noexcept { end_.since = now; }
  /// True if no further method of the end has ended for two limits and 100 ms. One limit is for the wait for other
  /// rtpus, one for the own method. `progress` is the number of methods that have ended. Context: main thread;
  /// wait-free.
  bool end_hangs(std::uint32_t progress, Nanoseconds now) noexcept {
    return end_.look(0, progress, false, now) > limit_ * 2 + milliseconds(100);
  }

 private:
  /// Two values, and since when they have not changed.
  struct Stall {
    /// How long the values have not changed; zero if nothing runs.
    Nanoseconds look(std::uint32_t method_now, std::uint64_t progress_now, bool is_idle, Nanoseconds now) noexcept {
      if (is_idle || method_now != method || progress_now != progress) *this = {method_now, progress_now, now};
      return now - since;
    }
    std::uint32_t method = 0;
    std::uint64_t progress = 0;
    Nanoseconds since = {};
  };

  const Nanoseconds limit_;
  Stall loop_, use_, method_, end_;  // use_: on the clock of the loop's thread
  Nanoseconds job_used_;
};

}  // namespace chimera
