// SPDX-License-Identifier: Apache-2.0
// Signals that are read when it suits, in place of handlers that run at any time.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <span>

#include "chimera/base/result.h"

namespace chimera {

/// While it lives its signals are blocked in the thread that made it, and in the threads that this one starts.
/// Move-only; its end restores the mask of the thread it ends in. Context: setup; never blocks.
class SignalQueue {
 public:
  struct Arrived {
    int number = 0;
    pid_t from = 0;  ///< who sent it; 0: the system
  };

  /// An empty queue blocks nothing.
  SignalQueue() noexcept;
  /// Blocks `numbers` and `ignored`; only those of `numbers` are told. Refuses with the system's reason.
  static Result<SignalQueue> open(std::span<const int> numbers, std::span<const int> ignored = {}) noexcept;
  SignalQueue(SignalQueue&&) noexcept;
  SignalQueue& operator=(SignalQueue&&) noexcept;
  ~SignalQueue();

  /// Its end restores nothing: what comes until the process ends stays unread.
  void stay_blocked() noexcept;
  /// The next signal that arrived; false when there is none.
  bool take(Arrived& arrived) noexcept;
  /// Readable when there is one; -1 of an empty queue.
  int descriptor() const noexcept;

 private:
  struct Content;  // the descriptor and the mask of before
  std::unique_ptr<Content> content_;
};

}  // namespace chimera
