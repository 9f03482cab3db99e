// SPDX-License-Identifier: Apache-2.0
// Asks the kernel for SCHED_FIFO, a CPU and locked memory, reads back the granted rights, and claims CPUs by sockets.
#include "chimera/platform/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "chimera/base/message.h"
#include "chimera/platform/file.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process_state.h"

namespace chimera {
namespace {

// Asks the kernel: pthread_getschedparam would answer from its own memory.
bool has_priority(int priority) noexcept {
  sched_param param{};
  return (::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO && ::sched_getparam(0, &param) == 0 &&
         param.sched_priority == priority;
}

// Threads and processes that this thread starts are ordinary.
bool set_fifo(int priority) noexcept {
  sched_param param{};
  param.sched_priority = priority;
  return ::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &param) == 0;
}

/// The reason why a right is not in force. 0: the kernel accepted the request and did not follow it.
const char* reason_text(int error) noexcept {
  return error != 0 ? ::strerrordesc_np(error) : "the call succeeded without effect";
}

/// Parts of the report: rights in force, and a line for each missing right.
struct Parts {
  Message granted;
  Message missing;

  Message& grant() noexcept { return granted << (granted.empty() ? "" : ", "); }
  Message& miss() noexcept { return missing << "\n  "; }
};

void set_priority(const RealtimeRequest& request, RealtimeGrant& grant, Parts& report) noexcept {
  if (request.priority == 0) {
    grant.priority = true;
    report.miss() << kAskedWords << " (priority 0): any job may come late";
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
                << "): set RLIMIT_RTPRIO to " << request.priority << " (is " << limit.rlim_cur
                << "; ulimit -r, LimitRTPRIO=) or give CAP_SYS_NICE";
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

// Memory counts as locked if the kernel reports locked pages.
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
  constexpr int kPlain = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void* const room = request.room == 0 ? MAP_FAILED : ::mmap(nullptr, request.room, PROT_NONE, kPlain, -1, 0);
  const int error = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
  if (room != MAP_FAILED) ::munmap(room, request.room);
  grant.memory = error == 0 && has_locked_memory();
  if (grant.memory) {
    report.grant() << kLockedWords;
    return;
  }
  report.miss() << "memory not locked (" << reason_text(error)
                << "): set RLIMIT_MEMLOCK to unlimited (ulimit -l, LimitMEMLOCK=) or give CAP_IPC_LOCK";
}

bool has_preempt_rt() noexcept {
  utsname kernel{};
  return ::uname(&kernel) == 0 && std::strstr(kernel.version, "PREEMPT_RT") != nullptr;
}

void write_report(const Parts& parts, RealtimeGrant& grant) noexcept {
  Message report;
  if (!parts.missing.empty()) {
    report << kMissingWords << parts.missing.view();
    if (!parts.granted.empty()) report << "\n  granted: " << parts.granted.view();
  } else {
    report << "Real-time OK: " << parts.granted.view() << ".";
    if (grant.throttle_share < 1)
      report << " Kernel limit for RT threads: " << std::lround(grant.throttle_share * 100) << " % of each "
             << realtime_period().count / 1'000'000 << " ms.";
    if (!has_preempt_rt()) report << " But " << kUnboundWords << ".";
  }
  grant.report.assign(report.view());
}

constexpr std::uint64_t kLeastStack = 256 << 10;     // of the first thread; threads of real-time processes have as much
constexpr std::uint64_t kLeastMemoryFile = 4 << 20;  // shared memory counts as a file

Result<void> at_least(int resource, std::uint64_t least, const char* what, const char* way_back) noexcept {
  rlimit limit{};
  if (::getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0 || limit.rlim_cur >= least) return {};
  return (Message() << what << " is limited to " << (limit.rlim_cur >> 10) << " KiB, expected at least "
                    << (least >> 10) << " KiB: " << way_back)
      .error(ErrorCode::kRefused);
}

// Any user may bind the name, even without a subsystem. The remedy depends on the process that holds the name.
Error in_use(int cpu, const NameHolder& who) noexcept {
  Message text;
  text << "CPU " << cpu << " is in use by ";
  if (who.process > 0)
    text << "another real-time subsystem (process " << who.process << " of user " << who.user << "): end that one, ";
  else
    text << "a process that does not answer: find it with `ss -xap | grep chimera-cpu-" << cpu << "` as root, end it, ";
  text << "place the rtpu on another CPU, or run with --priority 0";
  return text.error(ErrorCode::kRefused);
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

FixedString<400> not_real_time(std::string_view report) noexcept {
  Message line;
  if (const std::size_t begin = report.find(kMissingWords); begin != report.npos) {
    report = report.substr(0, report.find("\n  granted: ")).substr(begin + kMissingWords.size());
    for (std::size_t at = 0; at < report.size(); ++at) {
      const bool is_break = report.substr(at).starts_with("\n  ");
      if (is_break) at += 2;
      else line << report.substr(at, 1);
      if (is_break && !line.empty()) line << "; ";
    }
  } else if (report.find(kUnboundWords) != report.npos) {
    line << kUnboundWords;
  }
  FixedString<400> text;
  text.assign(line.view());
  return text;
}

RealtimeGrant enter_realtime(const RealtimeRequest& request) noexcept {
  RealtimeGrant grant;
  Parts parts;
  ::prctl(PR_SET_TIMERSLACK, 1);       // a thread without FIFO priority has 50 us by default
  lock_memory(request, grant, parts);  // first, so that its page faults do not happen at real-time priority
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
  // Without CAP_SYS_NICE a thread cannot clear SCHED_RESET_ON_FORK: the flag stays as it is.
  const int fifo = SCHED_FIFO | (policy & SCHED_RESET_ON_FORK);
  const bool granted = ::sched_setscheduler(0, fifo, &wanted) == 0 && has_priority(priority);
  ::sched_setscheduler(0, policy, &before);
  return granted;
}

Result<CpuClaim> CpuClaim::take(int cpu) noexcept {
  const Message name = Message() << "chimera-cpu-" << cpu;
  OwnedDescriptor claim = claim_name(name.view());
  if (claim.fd >= 0) return CpuClaim(std::move(claim));
  if (errno != EADDRINUSE) return system_error(Message() << "claim of CPU " << cpu, "bind");
  return in_use(cpu, holder_of_name(name.view()));
}

Result<void> may_open_here(std::uint64_t more) noexcept {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return {};
  const std::vector<pid_t> open = numbers_in("/proc/self/fd");  // with the folder itself, and without number 0
  const std::uint64_t least = (open.empty() ? limit.rlim_cur : open.size()) + more;
  if (limit.rlim_cur >= least) return {};
  return (Message() << "open files are limited to " << limit.rlim_cur << ", expected at least " << least
                    << ", or no process could be restarted: ulimit -n 1024, or LimitNOFILE= of the service")
      .error(ErrorCode::kRefused);
}

Result<void> may_run_here() noexcept {
  return at_least(RLIMIT_STACK, kLeastStack, "the stack", "ulimit -s 8192, or LimitSTACK= of the service");
}

Result<void> may_share_memory_here() noexcept {
  return at_least(RLIMIT_FSIZE, kLeastMemoryFile, "the file size (shared memory counts as a file)",
                  "ulimit -f unlimited, or LimitFSIZE= of the service");
}

}  // namespace chimera
