// SPDX-License-Identifier: Apache-2.0
// Signals that a thread reads when it is ready, instead of handlers that run at any time.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <span>

#include "chimera/base/result.h"

namespace chimera {

/// Blocks its signals during its lifetime, in the thread that made it and in threads that this thread starts.
/// Move-only; its end restores the mask of the thread in which it ends. Context: setup; never blocks.
class SignalQueue {
 public:
  struct Arrived {
    int number = 0;
    pid_t from = 0;  ///< the process that sent the signal; 0: the system
  };

  /// An empty queue blocks nothing.
  SignalQueue() noexcept;
  /// Blocks `numbers` and `ignored`; take() returns signals of `numbers` only. Refuses with the system's reason.
  static Result<SignalQueue> open(std::span<const int> numbers, std::span<const int> ignored = {}) noexcept;
  SignalQueue(SignalQueue&&) noexcept;
  SignalQueue& operator=(SignalQueue&&) noexcept;
  ~SignalQueue();

  /// From now on the end restores nothing: signals that arrive later stay unread until the process ends.
  void stay_blocked() noexcept;
  /// The next signal that arrived; false if there is none.
  bool take(Arrived& arrived) noexcept;
  /// Readable while there is a signal; -1 for an empty queue.
  int descriptor() const noexcept;

 private:
  struct Content;  // the descriptor and the mask before
  std::unique_ptr<Content> content_;
};

}  // namespace chimera
