// SPDX-License-Identifier: Apache-2.0
// A word on which one thread sleeps and anybody may wake it, across processes if need be (futex).
//
//   sleeper: seen = read() | look at everything | wait_until(seen, instant)
//   others:  write something | ring()
// What is written before ring() is seen by whoever wakes by it, or by its next look: no wake is lost, a wrong value
// of the word costs one look too many.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/platform/clock.h"

namespace chimera {

/// Who rings. The threads of one process find the sleeper faster.
enum class Ringers : std::uint8_t { kAnyProcess, kThisProcess };

/// Over a word in memory that outlives it; all who use it name the same ringers. Plain value.
class Doorbell {
 public:
  Doorbell() noexcept = default;
  explicit Doorbell(std::atomic<std::uint32_t>& word, Ringers ringers = Ringers::kAnyProcess) noexcept
      : word_(&word), ringers_(ringers) {}

  /// How often it rang. Context: cycle; wait-free.
  std::uint32_t read() const noexcept { return word_->load(std::memory_order_acquire); }  // pairs with ring()
  /// Wakes the sleeper, if there is one. Context: cycle; wait-free (one system call).
  void ring() const noexcept;
  /// Sleeps until `instant` on CLOCK_MONOTONIC (kNever: without end) or until it rings; at once when it rang since
  /// `seen`. May end early for no reason (kWoken). Context: cycle; blocks.
  WaitEnd wait_until(std::uint32_t seen, Nanoseconds instant) const noexcept;

 private:
  std::atomic<std::uint32_t>* word_ = nullptr;
  Ringers ringers_ = Ringers::kAnyProcess;
};

}  // namespace chimera
