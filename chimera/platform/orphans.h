// SPDX-License-Identifier: Apache-2.0
// Where processes come from, and the end of processes that components started and left behind: Orphans.
// docs/formats/processes.md, "What components start". A cgroup would be exact, but a user has one only where the login
// manager delegated it: not over ssh, not in most containers. A PID namespace needs a user namespace, which takes
// real-time rights away.
#pragma once

#include <sys/types.h>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/time.h"

namespace chimera {

/// The environment variable that holds the origin of a process: a word that all its descendants inherit, unless one of
/// them removes the word on purpose. An ordinary user may read the origin.
inline constexpr const char* kOriginVariable = "CHIMERA_ORIGIN";

/// The origin of process `pid` at the start of its program; "" without origin or if it cannot be read. Context: setup.
std::string origin_of(pid_t pid);

/// The name that process `pid` gave itself; "" if the process is gone. Context: setup.
std::string name_of(pid_t pid);

/// The children of this process, ended ones too, if the kernel lists them (CONFIG_PROC_CHILDREN). A child that starts
/// or ends during the call may be missing. Context: setup.
std::vector<pid_t> children_of_this_process();

/// Sends SIGKILL to every process of `origin` on this machine except the caller, until there is none, at most `limit`.
/// False if some remain. Context: setup; blocks.
bool end_all_from(std::string_view origin, Nanoseconds limit);

/// The processes that a keeper adopts: processes that components started and left behind, and memory holders.
/// Single-threaded. Context: setup; only end_all() blocks.
class Orphans {
 public:
  /// From now on each descendant of this process that loses its parent becomes its child. Children that this process
  /// has already are left alone: their parent became this program by exec.
  Orphans();

  /// The begin of every origin of this keeper; unique for this process.
  const std::string& prefix() const noexcept { return prefix_; }

  /// Reaps each ended child that is not among `held`, the numbers of children with a Process. Ends the tracing of each
  /// thread that a component had traced by this process (PTRACE_TRACEME): such a thread would stop at its next signal,
  /// and its process would not end before this one waited for the thread. Sends SIGKILL to each child of an rtpu that
  /// does not live; to a memory holder 100 ms after the first call that found it. A child of unknown origin stays until
  /// the end. `lives`: true if the rtpu of that origin lives.
  void look(std::span<const pid_t> held, const std::function<bool(std::string_view)>& lives, Nanoseconds now);
  /// When to call look() again even without an event; kNever: no need.
  Nanoseconds due() const noexcept { return due_; }

  /// After the end of all other processes: sends SIGKILL to all orphans, and to processes that become children by that,
  /// until there is none. Memory holders have 100 ms to end by themselves. Names on stderr each process that is left
  /// after `limit`.
  void end_all(Nanoseconds limit);

 private:
  struct Seen {
    pid_t pid;
    Nanoseconds at;
  };
  bool has_time(pid_t pid, Nanoseconds now);
  bool is_ours(pid_t pid, Nanoseconds now, bool& is_doubtful);
  Nanoseconds first_seen(pid_t pid, Nanoseconds now);
  std::vector<pid_t> living(std::span<const pid_t> held);

  std::string prefix_;
  std::vector<pid_t> strangers_;
  std::vector<Seen> seen_;
  Nanoseconds due_ = kNever;
};

}  // namespace chimera
