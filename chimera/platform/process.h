// SPDX-License-Identifier: Apache-2.0
// Child processes, held by pidfd: proof of death, and signals that never reach a stranger with the same number. And
// what a process does with itself: follow its parent, give way to others, die quickly.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <span>
#include <utility>

#include "chimera/base/message.h"
#include "chimera/base/result.h"
#include "chimera/base/time.h"

namespace chimera {

/// A process that was sent SIGKILL ends within this time. If it does not, the kernel holds it, and a caller goes on.
inline constexpr Nanoseconds kSigkillLimit = seconds(1);

/// How a process ended.
struct ProcessEnd {
  bool by_signal = false;
  int code = 0;  ///< exit status, or number of the signal
  bool core_dumped = false;
};

/// "signal 9 (SIGKILL)". Context: any; wait-free.
Message signal_text(int number) noexcept;

/// Place and limits of a child in a session of its own. Plain value.
struct ChildPlace {
  int output = -1, error = -1;  ///< its standard output and standard error
  bool is_bound = false;        ///< the kernel kills the child when this process dies
  std::uint64_t memory = 0;     ///< addresses of each of its processes, in bytes; 0: no limit. No sanitizer has one.
  std::uint64_t file = 0;       ///< bytes of a file that it writes; a write beyond fails; 0: no limit
};

/// A child. Move-only; closing the handle leaves the child alone. Context: setup.
class Process {
 public:
  /// Starts `program` by exec with `arguments` (argv[0] included; a null pointer is added). descriptors[i] becomes
  /// descriptor 3 + i of the child, which inherits no others but 0, 1 and 2. The child blocks the signal `blocked`
  /// (0: none) alone, until it is ready for that signal. The child ignores SIGINT and SIGHUP, because a terminal sends
  /// them to all processes and the parent answers them; also SIGPIPE and SIGXFSZ, so that a write fails instead of
  /// ending the child. Refuses with the system's reason. Call start() from one thread of the process only, the thread
  /// that lives longest: a child that follows its parent follows that thread.
  static Result<Process> start(const char* program, std::span<const char* const> arguments,
                               std::span<const int> descriptors, int blocked = 0) noexcept;

  /// Starts `program` as start() does, in a session of its own, without descriptors of this process: standard input is
  /// /dev/null. No signal of a terminal reaches the child, which ignores neither SIGINT nor SIGHUP.
  static Result<Process> start_apart(const char* program, std::span<const char* const> arguments,
                                     const ChildPlace& place) noexcept;

  Process() noexcept = default;
  Process(Process&& other) noexcept : pidfd_(std::exchange(other.pidfd_, -1)), pid_(std::exchange(other.pid_, -1)) {}
  Process& operator=(Process&& other) noexcept;
  ~Process();

  bool is_held() const noexcept { return pidfd_ >= 0; }
  int pidfd() const noexcept { return pidfd_; }  ///< readable after the end of the child
  pid_t pid() const noexcept { return pid_; }    ///< for messages; never send signals to this number
  /// True, once, after the child ended; reaps the child. Never blocks.
  bool has_ended(ProcessEnd& end) noexcept;
  /// Waits at most `limit_ns` for the end. True if the child ended (and was reaped).
  bool wait(ProcessEnd& end, std::int64_t limit_ns) noexcept;
  /// Sends a signal by pidfd. False after the end of the child.
  bool signal(int number) const noexcept;

 private:
  static Result<Process> start(const char* program, std::span<const char* const> arguments,
                               std::span<const int> descriptors, int blocked, const ChildPlace& place) noexcept;

  int pidfd_ = -1;
  pid_t pid_ = -1;
};

/// Sends `signal` to the process of that pidfd; false after its end. Context: any; one system call.
bool signal_process(int pidfd, int signal) noexcept;

/// True if process `pid` has ended, reaped or not. A process that got the same number later counts as living. Context:
/// cycle boundary; three system calls that do not wait.
bool has_process_ended(pid_t pid) noexcept;

/// By a child: from now on the kernel sends it `signal` when its parent dies. False if `parent` is not (or no longer)
/// the parent: then the caller should end. Context: setup.
bool follow_parent(pid_t parent, int signal) noexcept;

/// By a child: sends `signal` to its parent, by pidfd. False if `parent` is not (or no longer) the parent.
/// Context: setup.
bool signal_parent(pid_t parent, int signal) noexcept;

/// Ends this process by the default action of `signal`, even if the signal is blocked or ignored. Returns only if that
/// action does not end a process. Context: setup.
void end_by_signal(int signal) noexcept;

/// Programs that this process starts by exec do not inherit `descriptor`. Context: setup.
void close_at_exec(int descriptor) noexcept;

/// From now on this process and its threads give way to all others: a small share of the processors, the first to be
/// killed if memory runs out, no core image, and at most `memory` bytes of addresses; an allocation beyond fails. The
/// address and thread sanitizers need more memory: no such limit under them. A request that the system refuses is
/// skipped: results do not depend on these limits. Context: setup.
void run_in_background(std::uint64_t memory) noexcept;

/// Starts the memory holder: a second process that shares the memory of this process, does nothing, and frees that
/// memory after the death of this process. From now on this process dies quickly.
///
/// Linux frees the memory of a killed process before its pidfd becomes readable: milliseconds if the memory is locked,
/// on the processor and at the priority of the thread that ends last, even a SCHED_FIFO thread. Memory with another
/// user is not freed: the death is known at once, and the memory holder frees the memory later
/// (docs/design/guard.md).
///
/// The memory holder has no descriptor of this process, accepts no signal but SIGKILL, runs on idle processors only
/// (SCHED_IDLE), and ends some milliseconds after this process. False if the system grants no second process: then this
/// process dies slowly. Once per process, by its first thread, before the process opens descriptors that must not leak.
/// Context: setup.
bool start_memory_holder() noexcept;

}  // namespace chimera
