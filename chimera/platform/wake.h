// SPDX-License-Identifier: Apache-2.0
// Ways in which one thread waits and another wakes it: Doorbell, WakeEvent, DescriptorBell, Alarm, and the lock
// Section.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"

namespace chimera {

/// Where the threads that ring run. Threads of one process find the sleeper faster.
enum class Ringers : std::uint8_t { kAnyProcess, kThisProcess };

/// A word on which one thread sleeps and which any thread may ring, across processes too (futex).
///
///   sleeper: seen = read() | check everything | wait_until(seen, instant)
///   others:  write something | ring()
///
/// Data written before ring() is visible to the sleeper when it wakes, or at its next check: no wake is lost. A wrong
/// value of the word costs one unneeded check. The word outlives the Doorbell; all users of a word name the same
/// ringers. Plain value.
class Doorbell {
 public:
  Doorbell() noexcept = default;
  explicit Doorbell(std::atomic<std::uint32_t>& word, Ringers ringers = Ringers::kAnyProcess) noexcept
      : word_(&word), ringers_(ringers) {}

  /// Number of rings so far. Context: cycle; wait-free.
  std::uint32_t read() const noexcept { return word_->load(std::memory_order_acquire); }  // pairs with ring()
  /// Wakes the sleeper, if there is one. Context: cycle; wait-free (one system call).
  void ring() const noexcept;
  /// Sleeps until `instant` on CLOCK_MONOTONIC (kNever: without end) or until a ring; returns at once after a ring
  /// since `seen`. May end early without a reason (kWoken). Context: cycle; blocks.
  WaitEnd wait_until(std::uint32_t seen, Nanoseconds instant) const noexcept;

 private:
  std::atomic<std::uint32_t>* word_ = nullptr;
  Ringers ringers_ = Ringers::kAnyProcess;
};

/// Makes the descriptor of a WakeEvent readable. A number that is not open does nothing. Context: cycle; wait-free (one
/// system call).
void ring_event(int descriptor) noexcept;

/// A descriptor that any thread may make readable, for a thread that waits for several descriptors. Rings are not
/// counted: readable from the first ring until reset(). Movable; closes.
class WakeEvent {
 public:
  WakeEvent() noexcept = default;  ///< never readable
  /// Refuses with the system's reason; `what` begins the message. Context: setup.
  static Result<WakeEvent> open(const Message& what) noexcept;

  void ring() const noexcept { ring_event(event_.fd); }
  /// Not readable until the next ring. Context: setup; never blocks.
  void reset() const noexcept;
  int descriptor() const noexcept { return event_.fd; }

 private:
  explicit WakeEvent(OwnedDescriptor event) noexcept : event_(std::move(event)) {}
  OwnedDescriptor event_;
};

/// Where one thread waits until a descriptor is readable, and any thread may wake it. A ring before the wait ends the
/// wait at once, as with a Doorbell.
class DescriptorBell {
 public:
  /// Context: setup.
  DescriptorBell() noexcept;

  /// Wakes the sleeping thread, or ends the next wait at once. Context: cycle; wait-free (one system call).
  void ring() noexcept;
  /// Waits until `descriptor` is readable, has failed or is closed: true. False after a ring, or at `instant` on
  /// CLOCK_MONOTONIC (kNever: without end). Context: cycle; blocks.
  bool await(int descriptor, Nanoseconds instant) noexcept;

 private:
  OwnedDescriptor event_;
};

/// One instant on CLOCK_MONOTONIC for which one thread waits, and which other threads may move during the wait. Both
/// functions end the process if a component has closed or replaced the descriptor: end_without_descriptor().
class Alarm {
 public:
  /// Context: setup.
  Alarm() noexcept;
  bool is_there() const noexcept { return timer_.fd >= 0; }

  /// Rings at `instant` (in the past: at once; kNever: not at all), in place of the instant set before.
  /// Context: cycle; wait-free (one system call); any thread.
  void set(Nanoseconds instant) noexcept;
  /// Waits until the alarm rings. Context: cycle; blocks.
  void wait() noexcept;

 private:
  OwnedDescriptor timer_;
};

/// A lock for short, bounded pieces of code; not recursive. The holder neither blocks nor faults. If all users run at
/// one real-time level on one CPU, the lock is always free and costs two atomic operations. Without real-time rights,
/// or under a sanitizer, the lock excludes.
class Section {
 public:
  /// Context: cycle; wait-free while the section is free, otherwise blocks.
  void enter() noexcept {
    std::uint32_t free = kFree;
    if (!word_.compare_exchange_strong(free, kTaken, std::memory_order_acquire)) enter_taken();
  }
  /// Context: cycle; wait-free.
  void leave() noexcept {
    if (word_.exchange(kFree, std::memory_order_release) == kWanted) wake_one();
  }
  /// Number of enter() calls that found the section taken. Context: any; wait-free.
  std::uint64_t times_taken() const noexcept { return times_taken_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint32_t kFree = 0, kTaken = 1, kWanted = 2;  // wanted: taken, and a thread sleeps

  void enter_taken() noexcept;
  void wake_one() noexcept;

  // The release of leave() pairs with the acquire of enter() and enter_taken(): the next user sees all earlier writes.
  std::atomic<std::uint32_t> word_{kFree};
  std::atomic<std::uint64_t> times_taken_{0};  // relaxed: a figure that pairs with nothing
};

}  // namespace chimera
