// SPDX-License-Identifier: Apache-2.0
// Signals between tasks, and requests of tasks for a configuration: from the method that sent one to the cycle boundary
// that carries it out, or to another process.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/plan/switch_request.h"
#include "chimera/runtime/state/peer_view.h"
#include "chimera/runtime/state/task_memory.h"
#include "chimera/task/task.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; wait-free.
class SentSignals {
 public:
  /// `memories[t]` is planned for the tasks of this context; `others` null: there is no other. Context: setup.
  void prepare(std::span<Task> tasks, std::span<const TaskMemory> memories, PeerView* others) noexcept {
    tasks_ = tasks;
    memories_ = memories;
    others_ = others;
  }

  /// Hands the signals that `task` sent during its last method to their targets, and keeps its request.
  void deliver(Task& task) noexcept;
  /// The signal waits for the present method of the task to end.
  void defer(Task& task, Signal signal) noexcept;
  /// A failure needs a cycle boundary.
  void want_edge() noexcept {
    if (!wants_edge_) ++n_pending_;
    wants_edge_ = true;
  }
  /// The cycle boundary has dealt with it.
  void had_edge() noexcept {
    if (wants_edge_) --n_pending_;
    wants_edge_ = false;
  }
  /// True if some task has signals waiting, or a request does, or want_edge() was called. Context: cycle; wait-free.
  bool has_pending() const noexcept { return n_pending_ != 0; }
  /// Takes the oldest waiting signal of `task`; false if there is none.
  bool take_pending(Task& task, Signal& signal) noexcept;
  /// Tasks may ask for switches: the context carries requests out. `lists`, one for each task: also with lists of
  /// tasks. Context: setup.
  void allow_requests(std::span<TaskLists> lists) noexcept {
    takes_requests_ = true;
    lists_ = lists;
  }
  bool takes_requests() const noexcept { return takes_requests_; }
  /// Memory for the lists that the present method of the task asks for; nullptr: lists are not accepted. Context:
  /// cycle; wait-free.
  TaskLists* lists_of(TaskId task) const noexcept { return lists_.empty() ? nullptr : &lists_[task.index]; }
  /// The request waits for the next cycle boundary; it replaces the one that waited before.
  void request(const SwitchRequest& request) noexcept;
  /// The request that waits, once; false as a bool if there is none.
  SwitchRequest take_request() noexcept;
  /// Rings the doorbell of a task behind a server: one job for each ring, none is lost. False, with nothing done, when
  /// the task is not ON or has no server.
  bool ring(TaskId task) noexcept;

 private:
  bool is_mine(TaskId task) const noexcept { return !mechanisms::kPeers || memories_[task.index].is_planned(); }

  std::span<Task> tasks_;
  std::span<const TaskMemory> memories_;
  PeerView* others_ = nullptr;
  SwitchRequest request_;
  std::span<TaskLists> lists_;  // by task
  std::uint32_t n_pending_ = 0;  // signals, the request, and the need for a cycle boundary
  bool wants_edge_ = false;
  bool takes_requests_ = false;
};

}  // namespace chimera
