// SPDX-License-Identifier: Apache-2.0
// Forks quiet children, waits for their ends, and follows their system calls by ptrace.
#include "chimera/platform/forked_child.h"

#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>

#include "chimera/base/message.h"

namespace chimera {
namespace {

constexpr int kSystemCallStop = SIGTRAP | 0x80;  // PTRACE_O_TRACESYSGOOD
constexpr long kSlice = 20'000'000;              // ns

// The system calls that components use most.
struct CallName {
  long number;
  const char* name;
};

constexpr CallName kCallNames[] = {
    {SYS_read, "read"},
    {SYS_write, "write"},
    {SYS_openat, "openat"},
    {SYS_close, "close"},
    {SYS_lseek, "lseek"},
    {SYS_mmap, "mmap"},
    {SYS_munmap, "munmap"},
    {SYS_brk, "brk"},
    {SYS_ioctl, "ioctl"},
    {SYS_futex, "futex"},
    {SYS_socket, "socket"},
    {SYS_connect, "connect"},
    {SYS_sendto, "sendto"},
    {SYS_recvfrom, "recvfrom"},
    {SYS_sendmsg, "sendmsg"},
    {SYS_recvmsg, "recvmsg"},
    {SYS_ppoll, "ppoll"},
    {SYS_nanosleep, "nanosleep"},
    {SYS_clock_nanosleep, "clock_nanosleep"},
    {SYS_clock_gettime, "clock_gettime"},
    {SYS_getpid, "getpid"},
    {SYS_gettid, "gettid"},
    {SYS_sched_yield, "sched_yield"},
    {SYS_madvise, "madvise"},
    {SYS_mprotect, "mprotect"},
    {SYS_fsync, "fsync"},
    {SYS_exit_group, "exit_group"},
};

void be_quiet() noexcept {
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere < 0) return;
  for (const int stream : {0, 1, 2}) ::dup2(nowhere, stream);
  ::close(nowhere);
}

sigset_t child_signal() noexcept {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGCHLD);
  return set;
}

void tell_call(pid_t child, ChildWatcher& watcher) noexcept {
  __ptrace_syscall_info info{};
  if (ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info) < 0) return;
  if (info.op == PTRACE_SYSCALL_INFO_ENTRY) watcher.calls(info.entry.nr);
}

// Reacts to a stop of the child. Returns the signal that the child gets when it continues.
int answer_stop(pid_t child, int signal, bool& is_traced, ChildWatcher& watcher) noexcept {
  if (!is_traced && signal == SIGSTOP) {
    is_traced = true;
    ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
    return 0;
  }
  if (signal != kSystemCallStop) return signal;
  tell_call(child, watcher);
  return 0;
}

}  // namespace

Result<pid_t> fork_quietly(const std::string& folder, const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child < 0) return (Message() << "no process: " << std::strerror(errno)).error(ErrorCode::kSystem);
  if (child > 0) return child;
  be_quiet();
  if (!folder.empty() && ::chdir(folder.c_str()) != 0) ::_exit(1);
  ::_exit(work());  // no destructor or flush of the parent's objects
}

BlockedChildSignal::BlockedChildSignal() noexcept {
  const sigset_t set = child_signal();
  sigset_t before;
  pthread_sigmask(SIG_BLOCK, &set, &before);
  was_blocked_ = sigismember(&before, SIGCHLD) == 1;
}

void BlockedChildSignal::undo() noexcept {
  if (was_blocked_) return;
  const sigset_t set = child_signal();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

bool let_parent_trace() noexcept {
  if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) return false;
  return std::raise(SIGSTOP) == 0;
}

bool watch_child(pid_t child, ChildWatcher& watcher, ProcessEnd& end) noexcept {
  const sigset_t set = child_signal();
  const timespec slice{0, kSlice};
  bool is_traced = false, was_ended = false;
  for (;;) {
    int status = 0;
    if (waitpid(child, &status, WNOHANG | __WALL) != child) {  // still ours: not reaped yet
      if (!was_ended && watcher.has_waited_enough()) {
        was_ended = true;
        ::kill(child, SIGKILL);  // still ours: not reaped yet
      }
      sigtimedwait(&set, nullptr, &slice);
      continue;
    }
    if (WIFSTOPPED(status)) {
      const long signal = answer_stop(child, WSTOPSIG(status), is_traced, watcher);
      if (watcher.has_waited_enough()) {
        was_ended = true;
        ::kill(child, SIGKILL);  // still ours: not reaped yet
      }
      ptrace(PTRACE_SYSCALL, child, nullptr, signal);
      continue;
    }
    end = {WIFSIGNALED(status), WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status), false};
    return was_ended;
  }
}

std::string system_call_name(std::uint64_t number) {
  for (const CallName& one : kCallNames)
    if (static_cast<std::uint64_t>(one.number) == number) return one.name;
  return "system call " + std::to_string(number);
}

}  // namespace chimera
