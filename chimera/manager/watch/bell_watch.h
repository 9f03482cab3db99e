// SPDX-License-Identifier: Apache-2.0
// A doorbell as a descriptor. A loop in epoll cannot sleep on a word in memory, so a small thread does it.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "chimera/base/result.h"
#include "chimera/platform/wake.h"

namespace chimera::manager {

/// Context: setup. One reader.
class BellWatch {
 public:
  /// `bell` outlives it. Refuses if a descriptor or thread cannot be made.
  static Result<std::unique_ptr<BellWatch>> start(Doorbell bell);
  BellWatch(const BellWatch&) = delete;
  BellWatch& operator=(const BellWatch&) = delete;
  ~BellWatch();

  /// Readable after the bell rang.
  int descriptor() const noexcept { return event_.descriptor(); }
  /// Makes descriptor() unreadable until the bell rings again. Call it before reading the data behind the bell.
  void reset() const noexcept { event_.reset(); }

 private:
  BellWatch(Doorbell bell, WakeEvent event) : bell_(bell), event_(std::move(event)) {}
  void watch() noexcept;

  Doorbell bell_;
  WakeEvent event_;
  // Sequentially consistent: stored by the destructor before it rings the bell, loaded by watch() after each ring.
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace chimera::manager
