// SPDX-License-Identifier: Apache-2.0
// Charges the server of a task for the thread of that task, and halts the thread. docs/design/preemptive.md
#include "chimera/runtime/preemptive/sporadic_thread.h"

namespace chimera {
namespace {

// Capacity that is not worth a halt: about what one check of the supervisor takes.
constexpr Nanoseconds kSmallestCapacity = microseconds(25);

}  // namespace

SporadicThread::SporadicThread(const ServerSpec& spec) noexcept : job_(spec, kSmallestCapacity) {}

void SporadicThread::start(pid_t thread, Nanoseconds origin) noexcept {
  job_.start(origin);
  charged_ = used_by(thread);
}

void SporadicThread::charge(pid_t thread, bool is_free) noexcept {
  const Nanoseconds all = used_by(thread);
  if (all == kNever || all <= charged_) return;  // kNever: the thread is gone
  if (!is_free) job_.charge(all - charged_);
  charged_ = all;
}

void SporadicThread::halt() noexcept {
  is_halted_ = true;
  halt_.ask();
}

void SporadicThread::resume() noexcept {
  if (is_halted_) halt_.lift();
  is_halted_ = false;
}

void SporadicThread::finish(pid_t thread, bool is_free) noexcept {
  job_.finish();
  resume();
  charge(thread, is_free);
}

}  // namespace chimera
