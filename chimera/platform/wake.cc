// SPDX-License-Identifier: Apache-2.0
// Waits and wakes by futex, eventfd, ppoll and timerfd.
#include "chimera/platform/wake.h"

#include <linux/futex.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <ctime>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

static_assert(std::atomic<std::uint32_t>::is_always_lock_free && sizeof(std::atomic<std::uint32_t>) == 4);

constexpr timespec timespec_of(Nanoseconds time) noexcept {
  return {time.count / 1'000'000'000, time.count % 1'000'000'000};
}

// With FUTEX_PRIVATE_FLAG the kernel knows the word by its address; without, by its page in every process that maps it.
long futex(const std::atomic<std::uint32_t>* word, Ringers ringers, int operation, std::uint32_t value,
           const timespec* until) noexcept {
  const int scope = ringers == Ringers::kThisProcess ? FUTEX_PRIVATE_FLAG : 0;
  return ::syscall(SYS_futex, word, operation | scope, value, until, nullptr, FUTEX_BITSET_MATCH_ANY);
}

}  // namespace

void Doorbell::ring() const noexcept {
  word_->fetch_add(1, std::memory_order_release);  // pairs with read(): publishes earlier writes
  futex(word_, ringers_, FUTEX_WAKE, INT_MAX, nullptr);
}

WaitEnd Doorbell::wait_until(std::uint32_t seen, Nanoseconds instant) const noexcept {
  if (instant.count < 0) return WaitEnd::kReached;  // the kernel refuses a negative time
  const timespec t = timespec_of(instant);
  if (futex(word_, ringers_, FUTEX_WAIT_BITSET, seen, instant == kNever ? nullptr : &t) == 0) return WaitEnd::kWoken;
  CHIMERA_ASSERT(errno == ETIMEDOUT || errno == EAGAIN || errno == EINTR);
  return errno == ETIMEDOUT ? WaitEnd::kReached : WaitEnd::kWoken;
}

void ring_event(int descriptor) noexcept {
  const std::uint64_t one = 1;
  // A write to a full counter fails; the descriptor is readable all the same.
  [[maybe_unused]] const ssize_t written = ::write(descriptor, &one, sizeof one);
}

Result<WakeEvent> WakeEvent::open(const Message& what) noexcept {
  OwnedDescriptor event(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (event.fd < 0) return system_error(what, "eventfd");
  return WakeEvent(std::move(event));
}

void WakeEvent::reset() const noexcept {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(event_.fd, &count, sizeof count);  // fails if there was no ring
}

DescriptorBell::DescriptorBell() noexcept : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

void DescriptorBell::ring() noexcept { ring_event(event_.fd); }

bool DescriptorBell::await(int descriptor, Nanoseconds instant) noexcept {
  const Nanoseconds left = instant == kNever ? kNever : std::max(instant - LinuxClock().now(), Nanoseconds{});
  const timespec t = timespec_of(left);
  pollfd both[] = {{descriptor, POLLIN, 0}, {event_.fd, POLLIN, 0}};
  if (::ppoll(both, 2, instant == kNever ? nullptr : &t, nullptr) <= 0) return false;
  if ((both[1].revents & POLLNVAL) != 0) end_without_descriptor();
  std::uint64_t rings = 0;
  if (both[1].revents != 0 && ::read(event_.fd, &rings, sizeof rings) < 0) return false;
  return both[0].revents != 0;
}

Alarm::Alarm() noexcept : timer_{::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC)} {}

void Alarm::set(Nanoseconds instant) noexcept {
  itimerspec when{};
  if (instant != kNever) when.it_value = timespec_of(std::max(instant, Nanoseconds{1}));  // zero would switch it off
  // The waiting thread keeps a closed timer open: that thread would sleep on, and no other thread would notice.
  if (::timerfd_settime(timer_.fd, TFD_TIMER_ABSTIME, &when, nullptr) != 0) end_without_descriptor();
}

void Alarm::wait() noexcept {
  std::uint64_t times = 0;
  while (::read(timer_.fd, &times, sizeof times) < 0)
    if (errno != EINTR) end_without_descriptor();  // EINTR: a signal handler ran
}

// The three-state mutex over a futex (Drepper, Futexes Are Tricky, 2011, section 5).
void Section::enter_taken() noexcept {
  times_taken_.fetch_add(1, std::memory_order_relaxed);
  while (word_.exchange(kWanted, std::memory_order_acquire) != kFree)
    ::syscall(SYS_futex, &word_, FUTEX_WAIT_PRIVATE, kWanted, nullptr, nullptr, 0);
}

void Section::wake_one() noexcept { ::syscall(SYS_futex, &word_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0); }

}  // namespace chimera
