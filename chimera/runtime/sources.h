// SPDX-License-Identifier: Apache-2.0
// Where the value of every state variable comes from at present, and the inputs that follow it. Producers of the same
// context are read in place; all others (another context, the operator) through the register into local copies, one for
// each pair of a task and a group, so that variables of one group are always of one publication. Where tasks preempt
// each other each of them is a context of its own.
//
// A task whose job is under way keeps what it reads from; it follows with adopt() before its next one.
//
// Until a producer goes ON its consumers look at the initial values, or the never-written fill, of the first one.
#pragma once

#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/context_table.h"
#include "chimera/runtime/peer_view.h"
#include "chimera/runtime/source_copies.h"
#include "chimera/runtime/switch_plan.h"
#include "chimera/runtime/task_memory.h"
#include "chimera/runtime/variable_view.h"

namespace chimera {

/// Context of everything not marked: edge; no allocation. Everything given to prepare() outlives it.
class Sources {
 public:
  /// `memories[t]` is planned for the tasks of this context and empty for those of others; `others` null: there are
  /// none. `preemptive`: tasks of this context read each other through copies too. Context: setup.
  void prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<Task> tasks,
               std::span<TaskMemory> memories, const PeerView* others, bool preemptive, SetupMemory& memory);

  /// The task, of this context, went ON: whoever reads its variables reads them from its group now.
  void take_outputs_of(const Task& task) noexcept;
  /// Inputs of the task, which is OFF, read the new producers of the handovers that are among `armed`. All others read
  /// the present producers: a producer that is not armed yet has not written a value for this switch.
  void read_ahead(TaskId consumer, std::span<const Handover> handovers, std::span<const TaskId> armed) noexcept;
  /// From now on the variables of `handovers`, which outlive this, come from where they come from now, whatever the
  /// states of tasks elsewhere say; from hand_over() on from where the handovers say. That ends with end_handover().
  void begin_handover(std::span<const Handover> handovers) noexcept { handed_over_ = handovers; }
  /// The instant of the change. A task t with has_old_job[t] keeps what it reads from until old_job_ended().
  void hand_over(std::span<const bool> has_old_job) noexcept;
  void old_job_ended(TaskId consumer) noexcept;
  void end_handover() noexcept;
  /// Something changed elsewhere: follows producers that went ON or were replaced.
  void follow_others() noexcept;
  /// From now on nothing is read from the groups of that task (invalid: the operator): their memory may go. What was
  /// read last stays, until follow_others() finds it produced again.
  void let_go(TaskId producer) noexcept;
  /// The task reads from where its variables come from now; one with an old job (hand_over()) does not yet. Requires:
  /// no job of it has begun. Wait-free.
  void adopt(TaskId consumer) noexcept;
  /// It does not yet.
  bool is_behind(TaskId consumer) const noexcept { return is_behind_[consumer.index]; }
  /// Some task may still read what was let go.
  bool is_any_behind() const noexcept;

  const Source& source(VariableId variable) const noexcept { return sources_[variable.index]; }
  /// The latest slot of the group that the variable comes from: in place, or copied into memory of this object that is
  /// good until the next call. Null when there is none yet.
  const chimera_slot* latest(VariableId variable) noexcept;
  /// True when publication `sequence` of that group holds initial values: no method of its task has made it.
  bool is_initial(VariableId variable, std::uint64_t sequence) const noexcept;
  /// The present value. Requires: the variable is produced, or held, in this context.
  VariableView view(VariableId variable) const noexcept;

 private:
  bool is_mine(TaskId task) const noexcept { return memories_[task.index].is_planned(); }
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
