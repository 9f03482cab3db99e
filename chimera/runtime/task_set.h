// SPDX-License-Identifier: Apache-2.0
// The tasks of one context: their memory, their wiring, and the parts that act on them. The executors add time.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/changes.h"
#include "chimera/runtime/constant_store.h"
#include "chimera/runtime/illegal_flag.h"
#include "chimera/runtime/job_step.h"
#include "chimera/runtime/peer_layout.h"
#include "chimera/runtime/peer_view.h"
#include "chimera/runtime/sent_signals.h"
#include "chimera/runtime/service.h"
#include "chimera/runtime/slow_methods.h"
#include "chimera/runtime/sources.h"
#include "chimera/runtime/task_host.h"
#include "chimera/runtime/task_life.h"
#include "chimera/runtime/task_memory.h"
#include "chimera/runtime/task_methods.h"
#include "chimera/runtime/variables.h"
#include "chimera/task/task.h"

namespace chimera {

/// Present value of a state variable.
struct VariableView {
  const std::byte* value = nullptr;  ///< of the latest publication; nullptr: never bound
  const chimera_slot* slot = nullptr;
  const PortSpec* spec = nullptr;    ///< of the producing port; nullptr for operator variables
  std::uint32_t count = 0;
  bool is_valid = false;
};

/// A group in which a variable's value may stand.
struct VariableReader {
  GroupReader reader;
  std::uint32_t offset = 0;  ///< of the value in the payload
  std::uint32_t bit = 0;     ///< of the value in the valid bits
};

/// Where a context stands in the application. By default it is alone: all tasks and operator variables are its own.
struct ContextPlace {
  RtpuId rtpu;                     ///< whose tasks are its own; invalid: all
  std::span<std::byte> table;      ///< zeroed bytes for PeerLayout::of(spec, rtpu); empty: memory of its own
  PeerView* others = nullptr;
  Service* service = nullptr;  ///< null: init and kill run where the signal is taken
  // Words for whoever finds the process dead or hanging (TaskWord): written relaxed, pair with nothing.
  /// Told which task and method runs, as BlockHead::running says: by the context, and by the service thread.
  std::atomic<std::uint32_t>* running = &running_untold;
  std::atomic<std::uint32_t>* serving = &running_untold;
  bool preemptive = false;  ///< tasks preempt each other: each reads through copies of its own
  /// Told which method is called where a signal is taken; `running` goes on telling of jobs meanwhile.
  std::atomic<std::uint32_t>* at_edge = &running_untold;
  /// Told for which task a state is constructed, by show_making().
  std::atomic<std::uint32_t>* making = &running_untold;
};

/// Builds and holds the tasks of one context and everything about them but time. One thread at a time, but for
/// SlowMethods::run().
class TaskSet {
 public:
  /// Plans memory for every task and binds what can be bound. `components[i]` runs task i (not looked at for tasks of
  /// other contexts); `spec`, the components and what `place` names outlive the set. Refuses tasks that do not fit
  /// their component. Context: setup.
  static Result<std::unique_ptr<TaskSet>> create(const ApplicationSpec& spec,
                                                 std::span<const chimera_component* const> components,
                                                 const ContextPlace& place = {});
  TaskSet(const TaskSet&) = delete;
  TaskSet& operator=(const TaskSet&) = delete;
  ~TaskSet();

  /// Signals to tasks, and what follows from them.
  TaskLife& life() noexcept { return life_; }
  const TaskLife& life() const noexcept { return life_; }
  /// Signals that tasks sent.
  SentSignals& sent() noexcept { return sent_; }
  const SentSignals& sent() const noexcept { return sent_; }
  /// The illegal-configuration flag.
  IllegalFlag& flag() noexcept { return flag_; }
  const IllegalFlag& flag() const noexcept { return flag_; }
  /// How methods are called.
  TaskMethods& methods() noexcept { return methods_; }
  const TaskMethods& methods() const noexcept { return methods_; }
  /// What the service thread runs.
  SlowMethods& slow() noexcept { return slow_; }
  /// What other processes are to see, since it was published last. Nothing is listed in a context that is alone.
  Changes& changes() noexcept { return changes_; }
  /// Where the values of state variables come from.
  Sources& sources() noexcept { return sources_; }

  /// States of tasks changed: the flag is judged anew, and what is new to other processes is listed. Context: cycle
  /// boundary.
  void on_set_changed() noexcept;
  /// Something changed in another context: inputs follow, and all of on_set_changed(). Context: cycle boundary.
  void follow_others() noexcept;
  /// As IllegalFlag::raise_for(), and other processes are to see the flag at once. Context: cycle boundary.
  void raise_flag_for(TaskId task) noexcept;
  /// Between two jobs of the task; true when it had something to follow. Context: cycle boundary; wait-free.
  bool adopt(TaskId task) noexcept {
    if (!sources_.is_behind(task)) return false;
    sources_.adopt(task);
    return true;
  }
  /// Reads constants of other contexts; true when one that the task was initialised with has changed. Context: cycle
  /// boundary.
  bool uses_changed_constants(TaskId task) noexcept;
  /// Publishes a value of operator variable `index`. Requires: the context is alone; as many bytes as the description
  /// gives. Context: cycle boundary.
  void set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept;

  std::span<Task> tasks() noexcept { return tasks_; }
  std::span<const Task> tasks() const noexcept { return tasks_; }
  const TaskMemory& memory(TaskId task) const noexcept { return memories_[task.index]; }
  bool is_mine(TaskId task) const noexcept { return memories_[task.index].is_planned(); }
  /// There is no other context.
  bool is_alone() const noexcept { return place_.others == nullptr; }
  const ApplicationSpec& spec() const noexcept { return spec_; }
  const Variables& variables() const noexcept { return *variables_; }
  TaskId find(std::string_view name) const noexcept;
  /// Every group in which a value of variable `index` may stand (each producer has two, used in turn):
  /// for readers in other threads, who take the latest publication. Context: setup.
  std::vector<VariableReader> readers_of(std::size_t index) const;
  /// Latest value of variable `index` (Variables::all()). Context: cycle boundary.
  VariableView view(std::size_t index) const noexcept;

 private:
  friend class TaskLife;  // acts on what is held here

  /// A constant of another context.
  struct ForeignConstant {
    TaskId producer;
    ConstantId id;
    std::uint32_t offset = 0, bytes = 0;
  };

  TaskSet(const ApplicationSpec& spec, const ContextPlace& place) : spec_(spec), place_(place) {}
  Result<void> build(std::span<const chimera_component* const> components);
  void prepare_task(std::size_t t);
  Result<void> lay_out();
  std::span<std::byte> group_memory(GroupId group) const noexcept;
  void place_operators();
  void plan_foreign_constants();
  void read_foreign_constants() noexcept;
  void publish_constants(const Task& task) noexcept;
  std::span<const std::uint32_t> listed(const PortSpec& port) const noexcept;
  bool lists_fit(const Task& task, FixedString<160>& why) const noexcept;
  void reinit_users(TaskId of, Nanoseconds now);

  const ApplicationSpec& spec_;
  ContextPlace place_;
  std::vector<TaskMemory> memories_;
  std::vector<Task> tasks_;
  std::vector<TaskHost> hosts_;
  std::unique_ptr<Variables> variables_;
  std::unique_ptr<PeerLayout> everything_;  // of all groups of the application
  std::unique_ptr<PeerLayout> layout_;      // of the groups of this context
  AlignedBytes own_table_;                  // behind table_, unless the place gives it
  std::span<std::byte> table_;
  std::vector<GroupReader> operators_;
  Sources sources_;
  ConstantStore constants_;
  std::vector<ForeignConstant> foreign_constants_;
  AlignedBytes constant_scratch_;
  TaskMethods methods_;
  SlowMethods slow_;
  SentSignals sent_;
  IllegalFlag flag_;
  Changes changes_;
  TaskLife life_{*this};
  std::vector<bool> on_;            // by task, over all contexts: ON at the last on_set_changed()
  std::vector<TaskStatus> listed_;  // by task: the status that was listed in changes_ last
};

}  // namespace chimera
