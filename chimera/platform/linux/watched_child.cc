// SPDX-License-Identifier: Apache-2.0
// Waits for a forked child, and follows its system calls by ptrace.
#include "chimera/platform/watched_child.h"

#include <sys/ptrace.h>
#include <sys/wait.h>

#include <csignal>
#include <ctime>

namespace chimera {
namespace {

constexpr int kSystemCallStop = SIGTRAP | 0x80;  // PTRACE_O_TRACESYSGOOD
constexpr long kSlice = 20'000'000;              // ns

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

// The child stands still: says why, and what signal it gets when it goes on.
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

}  // namespace chimera
