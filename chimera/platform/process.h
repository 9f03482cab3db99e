// SPDX-License-Identifier: Apache-2.0
// Child processes, held by pidfd: proof of death, and signals that never reach a stranger with the same number.
#pragma once

#include <sys/types.h>

#include <span>
#include <utility>

#include "chimera/base/message.h"
#include "chimera/base/result.h"

namespace chimera {

/// How a process ended.
struct ProcessEnd {
  bool by_signal = false;
  int code = 0;  ///< exit status, or number of the signal
  bool core_dumped = false;
};

/// "signal 9 (SIGKILL)". Context: any; wait-free.
Message signal_text(int number) noexcept;

/// A child. Move-only; closing the handle leaves the child alone. Context: setup.
class Process {
 public:
  /// Starts `program` by exec with `arguments` (argv[0] included; a null pointer is added). descriptors[i] becomes
  /// descriptor 3 + i of the child; nothing else but 0, 1 and 2 is inherited. The signal mask of the child is empty but
  /// for the signal `blocked` (0: none), which waits until the child is ready for it; SIGINT and SIGHUP are ignored:
  /// those of a terminal reach everybody, and the parent answers them; so are SIGPIPE and SIGXFSZ: a write that fails
  /// ends nobody. Refuses with the system's reason. Call from one
  /// thread of the process only, the one that lives longest: a child that follows its parent follows that thread.
  static Result<Process> start(const char* program, std::span<const char* const> arguments,
                               std::span<const int> descriptors, int blocked = 0) noexcept;

  Process() noexcept = default;
  Process(Process&& other) noexcept : pidfd_(std::exchange(other.pidfd_, -1)), pid_(std::exchange(other.pid_, -1)) {}
  Process& operator=(Process&& other) noexcept;
  ~Process();

  bool is_held() const noexcept { return pidfd_ >= 0; }
  int pidfd() const noexcept { return pidfd_; }  ///< readable when it ended
  pid_t pid() const noexcept { return pid_; }    ///< for people; never to signal by
  /// True, once, when it ended; reaps it. Never blocks.
  bool has_ended(ProcessEnd& end) noexcept;
  /// Waits at most `limit_ns` for the end. True when it ended (and was reaped).
  bool wait(ProcessEnd& end, std::int64_t limit_ns) noexcept;
  /// Sends a signal by pidfd. False when it has ended.
  bool signal(int number) const noexcept;

 private:
  int pidfd_ = -1;
  pid_t pid_ = -1;
};

/// From now on, whoever loses its parent among this process's descendants becomes its child. Context: setup.
bool adopt_orphans() noexcept;

/// By a child: from now on it is sent `signal` when its parent dies. False when the parent is not `parent` (any more):
/// the caller should end. Context: setup.
bool follow_parent(pid_t parent, int signal) noexcept;

/// Ends this process by the default action of `signal`, even where it is blocked or ignored. Returns only where that
/// action ends nothing. Context: setup.
void end_by_signal(int signal) noexcept;

/// What this process starts by exec from now on does not have `descriptor`. Context: setup.
void close_at_exec(int descriptor) noexcept;

/// Sends `signal` to the process of that pidfd; false when it has ended. Context: any; one system call.
bool signal_process(int pidfd, int signal) noexcept;

/// By a child: sends `signal` to its parent, by pidfd. False when that is not `parent` (any more). Context: setup.
bool signal_parent(pid_t parent, int signal) noexcept;

}  // namespace chimera
