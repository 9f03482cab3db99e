// SPDX-License-Identifier: Apache-2.0
// Halts a thread inside of a signal handler, which sleeps on a futex until the thread may go on.
#include "chimera/platform/halt.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <climits>

#include "chimera/platform/processor_level.h"

namespace chimera {
namespace {

thread_local Halt* mine = nullptr;

bool install(void (*handler)(int)) noexcept {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  return ::sigaction(halt_signal(), &action, nullptr) == 0;
}

}  // namespace

Halt::Halt() noexcept {
  [[maybe_unused]] static const bool installed = install([](int signal) { handle(signal); });
}

void Halt::attach() noexcept {
  mine = this;
  thread_ = this_thread();
}

void Halt::handle(int) noexcept {
  const int before = errno;
  if (mine != nullptr) mine->sleep();
  errno = before;
}

void Halt::sleep() noexcept {
  while (word_.load(std::memory_order_acquire) == (kOpen | kAsked))  // pairs with lift()
    ::syscall(SYS_futex, &word_, FUTEX_WAIT_PRIVATE, kOpen | kAsked, nullptr, nullptr, 0);
}

void Halt::open() noexcept {
  (void)word_.fetch_or(kOpen, std::memory_order_acq_rel);
  sleep();
}

void Halt::ask() noexcept {
  (void)word_.fetch_or(kAsked, std::memory_order_acq_rel);
  (void)::syscall(SYS_tgkill, ::getpid(), thread_, halt_signal());
}

void Halt::lift() noexcept {
  (void)word_.fetch_and(~kAsked, std::memory_order_acq_rel);  // pairs with sleep(): it is seen by whoever looks again
  ::syscall(SYS_futex, &word_, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
}

}  // namespace chimera
