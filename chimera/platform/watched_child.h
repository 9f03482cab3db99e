// SPDX-License-Identifier: Apache-2.0
// A forked child that may be traced: each system call it makes is told, and it is ended when it hangs.
#pragma once

#include <sys/types.h>

#include <cstdint>

#include "chimera/platform/process.h"

namespace chimera {

/// What the parent does while the child runs. Context: setup.
class ChildWatcher {
 public:
  /// The child is about to make system call `number`; only of a traced one.
  virtual void calls(std::uint64_t number) noexcept = 0;
  /// Asked about every 20 ms: true ends the child by SIGKILL.
  virtual bool has_waited_enough() noexcept = 0;

 protected:
  ~ChildWatcher() = default;
};

/// By a child that was just forked: lets its parent, which calls watch_child(), trace it. False when the system does
/// not allow that; the child then goes on untraced. Only the calling thread is traced. Context: setup.
bool let_parent_trace() noexcept;

/// Waits for the end of a forked child, alive to its system calls when it let itself be traced. True when it had to be
/// ended. Requires: SIGCHLD is blocked since before the fork, by a BlockedChildSignal. Context: setup; may block.
bool watch_child(pid_t child, ChildWatcher& watcher, ProcessEnd& end) noexcept;

/// Blocks SIGCHLD for its lifetime; undo() in the child.
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

}  // namespace chimera
