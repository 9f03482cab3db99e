// SPDX-License-Identifier: Apache-2.0
// Asks the kernel for SCHED_FIFO, a CPU and locked memory, reads back what holds, and reports what is missing.
#include "chimera/platform/realtime.h"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "chimera/base/message.h"
#include "chimera/platform/linux/file_start.h"

namespace chimera {
namespace {

// Asked of the kernel: pthread_getschedparam answers with what it remembers.
bool has_priority(int priority) noexcept {
  sched_param param{};
  return (::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO && ::sched_getparam(0, &param) == 0 &&
         param.sched_priority == priority;
}

// What the thread starts is ordinary.
bool set_fifo(int priority) noexcept {
  sched_param param{};
  param.sched_priority = priority;
  return ::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &param) == 0;
}

/// Why a right is not in force: the kernel may accept a request and not follow it.
const char* reason_text(int error) noexcept {
  return error != 0 ? ::strerrordesc_np(error) : "the call succeeded without effect";
}

/// What the report is made of: what is in force, and a line for each thing that is not.
struct Parts {
  Message granted;
  Message missing;

  Message& grant() noexcept { return granted << (granted.empty() ? "" : ", "); }
  Message& miss() noexcept { return missing << "\n  "; }
};

void set_priority(const RealtimeRequest& request, RealtimeGrant& grant, Parts& report) noexcept {
  if (request.priority == 0) {
    grant.priority = true;
    report.miss() << "ordinary scheduling was asked for (priority 0): any job may come late";
    return;
  }
  const int error = set_fifo(request.priority) ? 0 : errno;
  grant.priority = error == 0 && has_priority(request.priority);
  if (grant.priority) {
    report.grant() << kLevelWords << request.priority;
    return;
  }
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  report.miss() << kLevelWords << request.priority << kRefusedWords << " (" << reason_text(error)
                << "): set RLIMIT_RTPRIO to "
                << request.priority << " (is " << limit.rlim_cur << "; ulimit -r, LimitRTPRIO=) or give CAP_SYS_NICE";
}

bool runs_only_on(int cpu) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::pthread_getaffinity_np(::pthread_self(), sizeof set, &set) != 0) return false;
  return CPU_COUNT(&set) == 1 && CPU_ISSET(static_cast<std::size_t>(cpu), &set) && ::sched_getcpu() == cpu;
}

void set_cpu(const RealtimeRequest& request, RealtimeGrant& grant, Parts& report) noexcept {
  if (request.cpu < 0) {
    grant.cpu = true;
    return;
  }
  int error = EINVAL;
  if (request.cpu < CPU_SETSIZE) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(request.cpu), &set);
    error = ::pthread_setaffinity_np(::pthread_self(), sizeof set, &set);
  }
  grant.cpu = error == 0 && runs_only_on(request.cpu);
  if (grant.cpu) {
    report.grant() << kPinnedWords << request.cpu;
    return;
  }
  const long last = ::sysconf(_SC_NPROCESSORS_ONLN) - 1;
  report.miss() << "CPU " << request.cpu << " refused";
  if (request.cpu > last)
    report.missing << ": this machine has CPU 0 to " << last;
  else
    report.missing << " (" << reason_text(error) << ")";
  report.missing << ", runs unpinned";
}

// Memory counts as locked when the kernel says that some of it is.
bool has_locked_memory() noexcept {
  const FileStart status("/proc/self/status");
  const char* line = std::strstr(status.bytes, "\nVmLck:");
  return line != nullptr && std::strtol(line + sizeof "\nVmLck:" - 1, nullptr, 10) > 0;
}

void lock_memory(const RealtimeRequest& request, RealtimeGrant& grant, Parts& report) noexcept {
  if (!request.lock_memory) {
    grant.memory = true;
    return;
  }
  const int error = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
  grant.memory = error == 0 && has_locked_memory();
  if (grant.memory) {
    report.grant() << kLockedWords;
    return;
  }
  report.miss() << "memory not locked (" << reason_text(error)
                << "): set RLIMIT_MEMLOCK to unlimited (ulimit -l, LimitMEMLOCK=) or give CAP_IPC_LOCK";
}

void write_report(const Parts& parts, RealtimeGrant& grant) noexcept {
  Message report;
  if (!parts.missing.empty()) {
    report << "WARNING: not real time" << parts.missing.view();
    if (!parts.granted.empty()) report << "\n  granted: " << parts.granted.view();
  } else {
    report << "Real-time OK: " << parts.granted.view() << ".";
    if (grant.throttle_share < 1)
      report << " Kernel limit for RT threads: " << std::lround(grant.throttle_share * 100) << " % of each "
             << realtime_period().count / 1'000'000 << " ms.";
  }
  grant.report.assign(report.view());
}

}  // namespace

double realtime_share() noexcept {
  const long runtime = std::strtol(FileStart("/proc/sys/kernel/sched_rt_runtime_us").bytes, nullptr, 10);
  const long period = std::strtol(FileStart("/proc/sys/kernel/sched_rt_period_us").bytes, nullptr, 10);
  if (runtime < 0 || period <= 0 || runtime >= period) return 1;
  return static_cast<double>(runtime) / static_cast<double>(period);
}

Nanoseconds realtime_period() noexcept {
  return microseconds(std::strtol(FileStart("/proc/sys/kernel/sched_rt_period_us").bytes, nullptr, 10));
}

RealtimeGrant enter_realtime(const RealtimeRequest& request) noexcept {
  RealtimeGrant grant;
  Parts parts;
  ::prctl(PR_SET_TIMERSLACK, 1);       // 50 us by default for a thread that gets no FIFO priority
  lock_memory(request, grant, parts);  // first: its page faults are no longer at real-time priority
  set_cpu(request, grant, parts);
  set_priority(request, grant, parts);
  if (request.priority > 0) grant.throttle_share = realtime_share();
  write_report(parts, grant);
  return grant;
}

bool may_be_realtime(int priority) noexcept {
  sched_param before{}, wanted{};
  wanted.sched_priority = priority;
  const int policy = ::sched_getscheduler(0);
  if (policy < 0 || ::sched_getparam(0, &before) != 0) return false;
  // Without CAP_SYS_NICE a thread cannot have SCHED_RESET_ON_FORK taken back: it keeps what it has of that.
  const int fifo = SCHED_FIFO | (policy & SCHED_RESET_ON_FORK);
  const bool granted = ::sched_setscheduler(0, fifo, &wanted) == 0 && has_priority(priority);
  ::sched_setscheduler(0, policy, &before);
  return granted;
}

}  // namespace chimera
