// SPDX-License-Identifier: Apache-2.0
// The present source of every state variable, and the inputs that follow it. Producers of the same context are read in
// place. All others (another context, the operator) are read through the register into local copies, one for each pair
// of a task and a group, so that variables of one group are always of one publication. Where tasks preempt each other,
// each task counts as a context of its own.
//
// A task whose job is under way keeps its sources; it follows with adopt() before its next job.
//
// Until a producer goes ON its consumers read the initial values, or the never-written fill, of the first producer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/runtime/state/context_table.h"
#include "chimera/runtime/state/peer_view.h"
#include "chimera/runtime/state/task_memory.h"
#include "chimera/runtime/state/variable_view.h"
#include "chimera/table/group.h"
#include "chimera/table/local_group.h"

namespace chimera {

/// Producer of a variable, and place of the value in its group.
struct Source {
  TaskId task;                ///< invalid: the operator
  std::size_t operator_index = 0;
  std::uint32_t offset = 0;   ///< of the value in the payload
  std::uint32_t bit = 0;      ///< of the value in the valid bits
  GroupReader here{};         ///< the group, where it lies in this context; else not bound
};

/// Both are values of one group.
constexpr bool is_same_group(const Source& a, const Source& b) noexcept {
  return a.task == b.task && (a.task.is_valid() || a.operator_index == b.operator_index);
}

/// The copies through which the tasks of a context read groups that are produced elsewhere: one for each pair of a task
/// and a group. Context of everything not marked: cycle boundary; no allocation. What prepare() is given outlives this.
class SourceCopies {
 public:
  /// Arguments as of Sources::prepare(). Context: setup.
  void prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<Task> tasks,
               std::span<TaskMemory> memories, const PeerView* others, bool preemptive, SetupMemory& memory);

  Source source_from(const PortOf& producer) const noexcept;
  /// The group of the source, in place or in another context; not bound: it is not there yet.
  GroupReader reader_of(const Source& source) const noexcept;
  /// The copy of the source's group for the task. Requires: it reads a variable of that group, produced elsewhere.
  LocalGroup& of(TaskId consumer, const Source& source) noexcept { return find(consumer, source)->group; }
  /// The task has a copy of a group of the producer.
  bool has(TaskId consumer, TaskId producer) const noexcept;

  /// Copies of producers that are ON, and of the operator, follow their present groups. Other copies keep their values:
  /// a restarted process shows a group without values before its tasks are ON again.
  void follow(TaskId consumer) noexcept;
  /// The copy of that source follows the present group in any state of the producer. No effect without a copy.
  void follow_now(TaskId consumer, const Source& source) noexcept;
  /// Stops reading the groups of the producer (invalid: the operator), and keeps the values read last.
  void let_go(TaskId producer) noexcept;
  /// The producer has new groups: kept values of it are not worth keeping.
  void forget(TaskId producer) noexcept;
  /// Lists in Task::copies the copies that the task reads.
  void list(TaskId consumer) noexcept;

 private:
  struct Copy {
    LocalGroup group;
    TaskId consumer;
    Source of;
    bool is_bound = false;   ///< to a group that may be read
    bool was_bound = false;  ///< its values are worth keeping
  };

  bool is_mine(TaskId task) const noexcept { return !mechanisms::kPeers || memories_[task.index].is_planned(); }
  std::uint32_t payload_of(const Source& source) const noexcept;
  void plan(const Variable& variable, SetupMemory& memory);
  void plan(TaskId consumer, const Source& source, SetupMemory& memory);
  void fill(const Source& source, std::span<std::byte> values) const noexcept;
  Copy* find(TaskId consumer, const Source& source) noexcept;
  void bind(Copy& copy, bool is_new) noexcept;

  const ApplicationSpec* spec_ = nullptr;
  const ContextTable* table_ = nullptr;
  std::span<Task> tasks_;
  std::span<TaskMemory> memories_;
  const PeerView* others_ = nullptr;
  std::span<Copy> copies_;
  std::span<std::span<LocalGroup*>> used_;  // by task: room for the bound copies that an input follows
  bool preemptive_ = false;
};

/// The operator as a source.
inline Source operator_source(const Variable& variable) noexcept {
  return {TaskId(), variable.operator_index, 0, 0, {}};
}

/// Context of everything not marked: cycle boundary; no allocation. Everything given to prepare() outlives it.
class Sources {
 public:
  /// `memories[t]` is planned for the tasks of this context and empty for those of others; `others` null: there are
  /// none. `preemptive`: tasks of this context read each other through copies too. Context: setup.
  void prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<Task> tasks,
               std::span<TaskMemory> memories, const PeerView* others, bool preemptive, SetupMemory& memory);

  /// The task, of this context, went ON: readers of its variables now read them from its group.
  void take_outputs_of(const Task& task) noexcept;
  /// Inputs of the task, which is OFF, read the new producers of the handovers that are among `armed`. All others read
  /// the present producers: a producer that is not armed yet has not written a value for this switch.
  void read_ahead(TaskId consumer, std::span<const Handover> handovers, std::span<const TaskId> armed) noexcept;
  /// Freezes the sources of `handovers`, which outlive this: they stay as they are now, whatever the states of tasks
  /// elsewhere say. From hand_over() on they are those of the handovers. end_handover() ends that.
  void begin_handover(std::span<const Handover> handovers) noexcept { handed_over_ = handovers; }
  /// The instant of the change. A task t with has_old_job[t] keeps its sources until old_job_ended().
  void hand_over(std::span<const bool> has_old_job) noexcept;
  void old_job_ended(TaskId consumer) noexcept;
  void end_handover() noexcept;
  /// The state of another context changed: follows producers that went ON or were replaced.
  void follow_others() noexcept;
  /// From now on nothing is read from the groups of that task (invalid: the operator), so their memory may be unmapped.
  /// The values read last stay, until follow_others() finds a producer again.
  void let_go(TaskId producer) noexcept;
  /// The task reads from the present sources of its variables, unless it has an old job (hand_over()). Requires: no job
  /// of it has begun. Wait-free.
  void adopt(TaskId consumer) noexcept;
  /// True if the task has not followed its sources yet.
  bool is_behind(TaskId consumer) const noexcept { return is_behind_[consumer.index]; }
  /// True if some task may still read from a group that was let go.
  bool is_any_behind() const noexcept;

  const Source& source(VariableId variable) const noexcept { return sources_[variable.index]; }
  /// The latest slot of the group that the variable comes from: in place, or copied into memory of this object that is
  /// good until the next call. Null if there is none yet.
  const chimera_slot* latest(VariableId variable) noexcept;
  /// True if publication `sequence` of that group holds initial values: no method of its task has made it.
  bool is_initial(VariableId variable, std::uint64_t sequence) const noexcept;
  /// The present value. Requires: the variable is produced, or held, in this context.
  VariableView view(VariableId variable) const noexcept;

 private:
  bool is_mine(TaskId task) const noexcept { return !mechanisms::kPeers || memories_[task.index].is_planned(); }
  void bind(VariableId variable, const Source& source) noexcept;
  void bind_input(Input& input, TaskId consumer, const Source& source) noexcept;
  bool keeps(TaskId consumer) const noexcept;
  bool is_handed_over(VariableId variable) const noexcept;
  void follow(TaskId consumer) noexcept;
  void everybody_follows() noexcept;

  const ApplicationSpec* spec_ = nullptr;
  const ContextTable* table_ = nullptr;
  std::span<Task> tasks_;
  std::span<TaskMemory> memories_;
  const PeerView* others_ = nullptr;
  std::span<Source> sources_;  // by variable
  SourceCopies copies_;
  std::span<bool> is_behind_;               // by task
  std::span<bool> has_old_job_;             // by task: released before the last hand_over()
  std::span<const Handover> handed_over_;   // between begin_handover() and end_handover()
  bool preemptive_ = false;
  std::span<std::byte> scratch_;            // a slot of the largest group
};

}  // namespace chimera
