// SPDX-License-Identifier: Apache-2.0
// A stream that a thread of its own writes to a descriptor: a thread that prints never waits for the reader.
#pragma once

#include <cstdio>
#include <memory>

#include "chimera/base/time.h"

namespace chimera::cli {

inline constexpr std::size_t kOutletBytes = 1 << 20;  ///< that wait for a reader; what comes then is lost

/// Context: setup; one thread prints.
class Outlet {
 public:
  /// `descriptor` stays the caller's, and open as long as the process lives: a write that does not return is left.
  explicit Outlet(int descriptor);
  ~Outlet();
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;

  /// To print to; null when there is no memory for it. Flushed, a text is on its way.
  std::FILE* stream() noexcept { return stream_; }
  /// Why something that was printed is lost, standard_output.h; 0: nothing is known to be. What is printed after a loss
  /// is tried again: a disk may have room again. Never blocks.
  int why_lost() const noexcept;
  /// Waits until everything is written, at most for `limit`; what is not then is lost.
  void finish(Nanoseconds limit);

 private:
  struct Queue;
  std::shared_ptr<Queue> queue_;  // the thread's as well
  std::FILE* stream_ = nullptr;
};

}  // namespace chimera::cli
