// SPDX-License-Identifier: Apache-2.0
// The tasks of one context: their memory, their wiring, and the parts that act on them. The executors add time.
#pragma once

#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/base/result.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/changes.h"
#include "chimera/runtime/life/illegal_flag.h"
#include "chimera/runtime/life/sent_signals.h"
#include "chimera/runtime/life/slow_methods.h"
#include "chimera/runtime/life/task_host.h"
#include "chimera/runtime/life/task_life.h"
#include "chimera/runtime/life/task_methods.h"
#include "chimera/runtime/plan/standbys.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/state/context_constants.h"
#include "chimera/runtime/state/context_place.h"
#include "chimera/runtime/state/context_table.h"
#include "chimera/runtime/state/sources.h"
#include "chimera/runtime/state/task_memory.h"
#include "chimera/task/task.h"

namespace chimera {

/// Builds and holds the tasks of one context and everything about them but time. One thread at a time, but for
/// SlowMethods::run().
class TaskSet {
 public:
  /// Everything that the set and its executors work in is taken from `memory`; all of it outlives the set. Context:
  /// setup.
  TaskSet(const ApplicationSpec& spec, const ContextPlace& place, SetupMemory& memory) noexcept
      : spec_(spec), place_(place), memory_(memory) {}
  TaskSet(const TaskSet&) = delete;
  TaskSet& operator=(const TaskSet&) = delete;
  ~TaskSet();
  /// Plans memory for every task and binds what can be bound, once. `components[i]` runs task i (not looked at for
  /// tasks of other contexts), and outlives the set. Refuses tasks that do not fit their component. Context: setup.
  Result<void> build(std::span<const chimera_component* const> components);

  /// Signals to tasks, and what follows from them.
  TaskLife& life() noexcept { return life_; }
  /// Signals that tasks sent.
  SentSignals& sent() noexcept { return sent_; }
  /// The illegal-configuration flag.
  IllegalFlag& flag() noexcept { return flag_; }
  /// Tasks that stand in for others, and the task that is to take over.
  Standbys& standbys() noexcept { return standbys_; }
  /// How methods are called.
  TaskMethods& methods() noexcept { return methods_; }
  /// Methods that the service thread runs.
  SlowMethods& slow() noexcept { return slow_; }
  /// Changes since the last publication, to be shown to other processes. A context that is alone lists nothing.
  Changes& changes() noexcept { return changes_; }
  /// Where the values of state variables come from.
  Sources& sources() noexcept { return sources_; }
  /// Where the groups of this context lie.
  ContextTable& table() noexcept { return table_; }
  /// The constants: passed from tasks that make them to tasks that are initialised with them.
  ContextConstants& constants() noexcept { return constants_; }

  /// From now on the flag is judged as if exactly the tasks in `target` were ON, except those in ERROR or NOT-CREATED:
  /// while a switch changes tasks in several contexts, the states are a mixture. Null: by the states again.
  void judge_as(const TaskBits* target) noexcept;
  /// States of tasks changed: the flag is judged anew, and what is new to other processes is listed. Context: cycle
  /// boundary.
  void on_set_changed() noexcept;
  /// Call between two jobs of the task. True if the task had new sources to follow. Context: cycle boundary; wait-free.
  bool adopt(TaskId task) noexcept {
    if (!sources_.is_behind(task)) return false;
    sources_.adopt(task);
    return true;
  }

  std::span<Task> tasks() noexcept { return tasks_; }
  std::span<const Task> tasks() const noexcept { return tasks_; }
  TaskMemory& memory(TaskId task) noexcept { return memories_[task.index]; }
  bool is_mine(TaskId task) const noexcept { return !mechanisms::kPeers || memories_[task.index].is_planned(); }
  /// The number of this context among those of the application: that of its rtpu; 0 when it is alone.
  std::uint32_t context() const noexcept { return place_.rtpu.is_valid() ? place_.rtpu.index : 0; }
  /// View of other contexts; null: there is none.
  PeerView* others() const noexcept { return mechanisms::kPeers ? place_.others : nullptr; }
  const ContextPlace& place() const noexcept { return place_; }
  const ApplicationSpec& spec() const noexcept { return spec_; }
  /// Where the set and its executors take their memory from. Context: setup.
  SetupMemory& setup_memory() noexcept { return memory_; }

 private:
  bool counts_as_on(TaskId task) const noexcept;
  Result<void> plan_memories(std::span<const chimera_component* const> components);
  void prepare_parts();
  void prepare_task(std::size_t t, const chimera_component* component);

  const ApplicationSpec& spec_;
  ContextPlace place_;
  SetupMemory& memory_;
  std::span<TaskMemory> memories_;
  std::span<Task> tasks_;
  std::span<TaskHost> hosts_;
  ContextTable table_;
  Sources sources_;
  ContextConstants constants_;
  TaskMethods methods_;
  SlowMethods slow_;
  SentSignals sent_;
  IllegalFlag flag_;
  Standbys standbys_;
  Changes changes_;
  TaskLife life_{*this};
  std::span<bool> on_;            // by task, over all contexts: ON at the last on_set_changed()
  std::span<State> states_;       // by task, over all contexts, at the last on_set_changed()
  const TaskBits* target_ = nullptr;  // in place of the states, while they change
  std::span<TaskStatus> listed_;  // by task: the status that was listed in changes_ last
};

}  // namespace chimera
