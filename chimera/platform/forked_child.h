// SPDX-License-Identifier: Apache-2.0
// Forked children that do one piece of work and end: fork_quietly() starts one, watch_child() follows its system calls.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>

#include "chimera/base/result.h"
#include "chimera/platform/process.h"

namespace chimera {

/// Forks a child that runs `work` with its standard streams on /dev/null, in the folder `folder` ("": the folder of its
/// parent). The exit status is the result of `work`, or 1 if the child cannot enter the folder. The child flushes and
/// destroys nothing that belongs to its parent. Returns the number of the child, for watch_child(); refuses with the
/// system's reason. Context: setup.
Result<pid_t> fork_quietly(const std::string& folder, const std::function<int()>& work);

/// Work of the parent while the child runs. Context: setup.
class ChildWatcher {
 public:
  /// The child is about to make system call `number`. Called for a traced child only.
  virtual void calls(std::uint64_t number) noexcept = 0;
  /// Called about every 20 ms: true ends the child by SIGKILL.
  virtual bool has_waited_enough() noexcept = 0;

 protected:
  ~ChildWatcher() = default;
};

/// By a child after the fork: lets its parent, which calls watch_child(), trace it. False if the system does not allow
/// tracing; the child then continues untraced. Only the calling thread is traced. Context: setup.
bool let_parent_trace() noexcept;

/// Waits for the end of a forked child and reports the system calls of a traced child to `watcher`. True if the watcher
/// ended the child. Requires: a BlockedChildSignal exists since before the fork. Context: setup; may block.
bool watch_child(pid_t child, ChildWatcher& watcher, ProcessEnd& end) noexcept;

/// Blocks SIGCHLD for its lifetime. The child calls undo().
class BlockedChildSignal {
 public:
  BlockedChildSignal() noexcept;
  BlockedChildSignal(const BlockedChildSignal&) = delete;
  BlockedChildSignal& operator=(const BlockedChildSignal&) = delete;
  ~BlockedChildSignal() { undo(); }
  void undo() noexcept;

 private:
  bool was_blocked_ = false;
};

/// "write"; "system call 437" for a number that components seldom use. Context: any.
std::string system_call_name(std::uint64_t number);

}  // namespace chimera
