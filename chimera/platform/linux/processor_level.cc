// SPDX-License-Identifier: Apache-2.0
// Changes SCHED_FIFO priorities of threads and reads the clocks of their execution time.
#include "chimera/platform/processor_level.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <string_view>

#include "chimera/platform/owned_descriptor.h"

namespace chimera {
namespace {

// The clock of another thread of this process, as pthread_getcpuclockid makes it of the thread's number.
clockid_t cpu_clock_of(pid_t thread) noexcept {
  constexpr unsigned kPerThread = 4, kSchedulerTime = 2;
  return static_cast<clockid_t>((~static_cast<unsigned>(thread) << 3) | kPerThread | kSchedulerTime);
}

Nanoseconds read(clockid_t clock) noexcept {
  timespec t{};
  if (::clock_gettime(clock, &t) != 0) return kNever;
  return {static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec};
}

}  // namespace

pid_t this_thread() noexcept { return static_cast<pid_t>(::syscall(SYS_gettid)); }

bool set_level(pid_t thread, int level) noexcept {
  sched_param p{};
  p.sched_priority = level;
  return ::sched_setscheduler(thread, SCHED_FIFO | SCHED_RESET_ON_FORK, &p) == 0;
}

bool set_below_all(pid_t thread) noexcept {
  const sched_param p{};
  return ::sched_setscheduler(thread, SCHED_OTHER | SCHED_RESET_ON_FORK, &p) == 0;
}

int level_of(pid_t thread) noexcept {
  sched_param p{};
  return ::sched_getparam(thread, &p) == 0 ? p.sched_priority : 0;
}

Nanoseconds used_by(pid_t thread) noexcept { return read(cpu_clock_of(thread)); }

Nanoseconds used_by_this_thread() noexcept { return read(CLOCK_THREAD_CPUTIME_ID); }

bool is_asleep(pid_t thread) noexcept {
  char path[48], text[128];
  std::snprintf(path, sizeof path, "/proc/self/task/%d/stat", thread);
  const OwnedDescriptor file{::open(path, O_RDONLY | O_CLOEXEC)};
  if (file.fd < 0) return false;
  const ssize_t n = ::read(file.fd, text, sizeof text);
  const std::string_view all(text, n > 0 ? static_cast<std::size_t>(n) : 0);
  const std::size_t name_end = all.rfind(')');  // a name may hold anything; it has at most 15 characters
  if (name_end == all.npos || name_end + 2 >= all.size()) return false;
  const char state = all[name_end + 2];
  return state == 'S' || state == 'D';
}

std::uint64_t sleeps_of_this_thread() noexcept {
  rusage usage{};
  (void)::getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_nvcsw);
}

}  // namespace chimera
