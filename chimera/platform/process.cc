// SPDX-License-Identifier: Apache-2.0
// Starts programs by fork and exec with named descriptors only, holds them by pidfd, and clones the memory holder.
#include "chimera/platform/process.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstddef>
#include <ctime>

#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"

namespace chimera {
namespace {

// By number: the C library's header declares them without C linkage.
int pidfd_open(pid_t pid) noexcept { return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)); }
bool pidfd_send_signal(int pidfd, int number) noexcept {
  return ::syscall(SYS_pidfd_send_signal, pidfd, number, nullptr, 0) == 0;
}

constexpr std::size_t kMaxArguments = 1000;
constexpr std::size_t kMaxPassed = 16;
constexpr int kFirst = 3;  // number of the first passed descriptor in the child
constexpr int kBackgroundNice = 10;
constexpr char kFirstToEnd[] = "1000";  // of oom_score_adj
// Every process that waits for the death sees it within this time, and the memory holder still ends soon.
constexpr timespec kRespite{0, 10'000'000};

alignas(64) std::byte holder_stack[16 * 1024];

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsSanitized = true;  // needs more memory than any limit of this project
#else
constexpr bool kIsSanitized = false;
#endif

bool limit_to(__rlimit_resource what, std::uint64_t most) noexcept {
  const rlimit bound{most, most};
  return ::setrlimit(what, &bound) == 0;
}

/// In the child: a session of its own, its standard streams and its limits.
bool stand_apart(const ChildPlace& place, pid_t parent) noexcept {
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  return ::setsid() >= 0 && nothing >= 0 && ::dup2(nothing, 0) >= 0 && ::dup2(place.output, 1) >= 0 &&
         ::dup2(place.error, 2) >= 0 && (!place.is_bound || follow_parent(parent, SIGKILL)) &&
         (place.memory == 0 || kIsSanitized || limit_to(RLIMIT_AS, place.memory)) &&
         (place.file == 0 || limit_to(RLIMIT_FSIZE, place.file));
}

// In the child, between fork and exec: nothing here may allocate, lock or return.
[[noreturn]] void become(const char* program, char* const* words, std::span<const int> passed, int failed, int blocked,
                         const ChildPlace& place, pid_t parent) noexcept {
  const int above = kFirst + static_cast<int>(passed.size());
  // Copy to higher numbers first: a descriptor to pass may itself be 3 or 4 here. exec closes the copies.
  int copies[kMaxPassed] = {};
  const int report = ::fcntl(failed, F_DUPFD_CLOEXEC, above);
  bool good = report >= 0;
  for (std::size_t i = 0; good && i < passed.size(); ++i) {
    copies[i] = ::fcntl(passed[i], F_DUPFD_CLOEXEC, above);
    good = copies[i] >= 0;
  }
  for (std::size_t i = 0; good && i < passed.size(); ++i) good = ::dup2(copies[i], kFirst + static_cast<int>(i)) >= 0;
  // Descriptors that the parent left open without close-on-exec end at exec too.
  good = good && ::close_range(static_cast<unsigned>(above), UINT_MAX, CLOSE_RANGE_CLOEXEC) == 0;
  good = good && (place.output < 0 || stand_apart(place, parent));
  const int passing_error = good ? 0 : errno;
  for (int number = 1; number < NSIG; ++number) ::signal(number, SIG_DFL);
  for (const int number : {SIGPIPE, SIGXFSZ}) ::signal(number, SIG_IGN);
  if (place.output < 0)  // else no terminal sends these
    for (const int number : {SIGINT, SIGHUP}) ::signal(number, SIG_IGN);
  sigset_t mask;
  ::sigemptyset(&mask);
  if (blocked != 0) ::sigaddset(&mask, blocked);
  ::sigprocmask(SIG_SETMASK, &mask, nullptr);
  if (good) ::execv(program, words);
  const int error = passing_error != 0 ? passing_error : errno;
  if (::write(report >= 0 ? report : failed, &error, sizeof error) < 0) ::_exit(126);
  ::_exit(127);
}

// Runs in the memory holder, with the memory and thread-local storage of the other process: system calls only.
int outlive(void* pidfd) noexcept {
  const sched_param none{};
  ::syscall(SYS_sched_setscheduler, 0, SCHED_IDLE, &none);
  ::syscall(SYS_prctl, PR_SET_NAME, "memory-holder", 0, 0, 0);
  ::syscall(SYS_dup2, reinterpret_cast<std::intptr_t>(pidfd), 0);
  ::syscall(SYS_close_range, 1, UINT_MAX, 0);  // descriptors of the other process must close at its death
  pollfd dead{0, POLLIN, 0};
  while (::syscall(SYS_poll, &dead, 1, -1) == 0) {
  }
  ::syscall(SYS_nanosleep, &kRespite, nullptr);
  ::syscall(SYS_exit_group, 0);
  return 0;
}

}  // namespace

Message signal_text(int number) noexcept {
  Message text = Message() << "signal " << number;
  const char* name = ::sigabbrev_np(number);
  return name == nullptr ? text : text << " (SIG" << name << ")";
}

Result<Process> Process::start(const char* program, std::span<const char* const> arguments,
                               std::span<const int> descriptors, int blocked) noexcept {
  return start(program, arguments, descriptors, blocked, {});
}

Result<Process> Process::start_apart(const char* program, std::span<const char* const> arguments,
                                     const ChildPlace& place) noexcept {
  return start(program, arguments, {}, 0, place);
}

Result<Process> Process::start(const char* program, std::span<const char* const> arguments,
                               std::span<const int> descriptors, int blocked, const ChildPlace& place) noexcept {
  const Message what = Message() << "program " << program;
  if (arguments.size() > kMaxArguments || descriptors.size() > kMaxPassed)
    return (Message() << what.view() << ": more than " << kMaxArguments << " arguments or " << kMaxPassed
                      << " descriptors")
        .error(ErrorCode::kBadInput);
  char* words[kMaxArguments + 1] = {};
  for (std::size_t i = 0; i < arguments.size(); ++i) words[i] = const_cast<char*>(arguments[i]);
  int pipe_ends[2];
  if (::pipe2(pipe_ends, O_CLOEXEC) != 0) return system_error(what, "pipe");
  const OwnedDescriptor answer(pipe_ends[0]);
  OwnedDescriptor failed(pipe_ends[1]);
  // No handler of this process may run in the child.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t self = ::getpid(), pid = ::fork();
  if (pid == 0) become(program, words, descriptors, failed.fd, blocked, place, self);
  const int fork_error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = fork_error;
  if (pid < 0) return system_error(what, "fork");
  Process child;
  child.pid_ = pid;
  child.pidfd_ = pidfd_open(pid);  // close-on-exec; the number belongs to the child until it is reaped
  const int pidfd_error = errno;
  failed = OwnedDescriptor();
  int error = 0;
  ssize_t got;
  do got = ::read(answer.fd, &error, sizeof error);
  while (got < 0 && errno == EINTR);
  if (got == 0 && child.pidfd_ >= 0) return child;
  if (got == 0) ::kill(pid, SIGKILL);                         // still ours: not reaped yet
  while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {  // still ours
  }
  errno = got == 0 ? pidfd_error : error;
  return system_error(what, got == 0 ? "pidfd_open" : "exec");
}

Process& Process::operator=(Process&& other) noexcept {
  std::swap(pidfd_, other.pidfd_);
  std::swap(pid_, other.pid_);
  return *this;
}

Process::~Process() {
  if (pidfd_ >= 0) ::close(pidfd_);
}

bool Process::has_ended(ProcessEnd& end) noexcept {
  if (pidfd_ < 0) return false;
  siginfo_t info{};
  if (::waitid(P_PIDFD, static_cast<id_t>(pidfd_), &info, WEXITED | WNOHANG) != 0 || info.si_pid == 0) return false;
  end.by_signal = info.si_code != CLD_EXITED;
  end.code = info.si_status;
  end.core_dumped = info.si_code == CLD_DUMPED;
  ::close(std::exchange(pidfd_, -1));
  pid_ = -1;
  return true;
}

bool Process::wait(ProcessEnd& end, std::int64_t limit_ns) noexcept {
  LinuxClock clock;
  const Nanoseconds until = clock.now() + std::min(Nanoseconds{limit_ns}, seconds(1'000'000'000));
  while (pidfd_ >= 0) {
    if (has_ended(end)) return true;
    const Nanoseconds left = std::max(until - clock.now(), Nanoseconds{0});
    if (left.count == 0) return false;
    const timespec patience{left.count / 1'000'000'000, left.count % 1'000'000'000};
    pollfd ended{pidfd_, POLLIN, 0};
    ::ppoll(&ended, 1, &patience, nullptr);
  }
  return false;
}

bool Process::signal(int number) const noexcept { return pidfd_ >= 0 && pidfd_send_signal(pidfd_, number); }

bool signal_process(int pidfd, int signal) noexcept { return pidfd_send_signal(pidfd, signal); }

bool has_process_ended(pid_t pid) noexcept {
  const OwnedDescriptor held(pidfd_open(pid));
  if (held.fd < 0) return errno == ESRCH;
  pollfd dead{held.fd, POLLIN, 0};
  return ::poll(&dead, 1, 0) > 0;
}

bool follow_parent(pid_t parent, int signal) noexcept {
  return ::prctl(PR_SET_PDEATHSIG, signal) == 0 && ::getppid() == parent;
}

bool signal_parent(pid_t parent, int signal) noexcept {
  const int pidfd = pidfd_open(parent);
  if (pidfd < 0) return false;
  // If the process is still the parent now, it was the parent when the descriptor was made: no stranger's number.
  const bool sent = ::getppid() == parent && pidfd_send_signal(pidfd, signal);
  ::close(pidfd);
  return sent;
}

void end_by_signal(int signal) noexcept {
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, signal);
  ::signal(signal, SIG_DFL);
  ::raise(signal);
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void close_at_exec(int descriptor) noexcept { ::fcntl(descriptor, F_SETFD, FD_CLOEXEC); }

void run_in_background(std::uint64_t memory) noexcept {
  (void)::setpriority(PRIO_PROCESS, 0, kBackgroundNice);
  (void)limit_to(RLIMIT_CORE, 0);
  if (!kIsSanitized) (void)limit_to(RLIMIT_AS, memory);
  const OwnedDescriptor score(::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC));
  if (score.fd >= 0) (void)!::write(score.fd, kFirstToEnd, sizeof kFirstToEnd - 1);
}

bool start_memory_holder() noexcept {
  const OwnedDescriptor self(pidfd_open(::getpid()));
  if (self.fd < 0) return false;
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  void* const pidfd = reinterpret_cast<void*>(static_cast<std::intptr_t>(self.fd));  // NOLINT: a number all the way
  // No signal of its end: the parent does not wait for it.
  const int pid = ::clone(outlive, holder_stack + sizeof holder_stack, CLONE_VM, pidfd);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return pid > 0;
}

}  // namespace chimera
