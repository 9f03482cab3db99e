// SPDX-License-Identifier: Apache-2.0
// Whether the methods of a real-time unit still come to an end, asked by its main thread, which none of them delays.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"

namespace chimera {

/// Used by the main thread only. Remembers what it was shown last and since when nothing of it has changed.
class HangWatch {
 public:
  /// `method_limit`: how long one method may take.
  explicit HangWatch(Nanoseconds method_limit) noexcept : limit_(method_limit) {}

  /// True when the one loop has been in one method for longer than the limit: no cycle boundary comes then.
  /// `running` is the method (BlockHead::running; 0: it waits), `beats` grows with each edge and each job that has
  /// ended. Context: main thread; wait-free.
  bool loop_hangs(std::uint32_t running, std::uint64_t beats, Nanoseconds now) noexcept;

  /// True when one method that an edge or the service thread called has been under way for longer than the limit.
  /// `method` is the one (0: none), `progress` grows with each that begins or ends. Context: main thread; wait-free.
  bool method_hangs(std::uint32_t method, std::uint32_t progress, Nanoseconds now) noexcept;

  /// For how long one method may take.
  Nanoseconds limit() const noexcept { return limit_; }

  /// From here on the unit ends. Context: main thread; wait-free.
  void begin_end(Nanoseconds now) noexcept { progress_at_ = now; }
  /// True when no method of the end has come to its own end for two limits and 100 ms: what waits for others waits one
  /// limit more than it has itself. `progress` is the number of those that are done. Context: main thread; wait-free.
  bool end_hangs(std::uint32_t progress, Nanoseconds now) noexcept;

 private:
  const Nanoseconds limit_;
  std::uint64_t beats_ = 0;
  std::uint32_t running_ = 0, method_ = 0, method_progress_ = 0;
  Nanoseconds beaten_at_, method_at_;
  std::uint32_t progress_ = 0;
  Nanoseconds progress_at_;
};

}  // namespace chimera
