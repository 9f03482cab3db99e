// SPDX-License-Identifier: Apache-2.0
// The copies through which the tasks of a context read groups that are produced elsewhere: one for each pair of a task
// and a group, so that variables of one group are always of one publication. Where tasks preempt each other each of
// them is a context of its own.
#pragma once

#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/context_table.h"
#include "chimera/runtime/peer_view.h"
#include "chimera/runtime/source.h"
#include "chimera/runtime/task_memory.h"
#include "chimera/table/local_group.h"

namespace chimera {

/// Context of everything not marked: edge; no allocation. Everything given to prepare() outlives it.
class SourceCopies {
 public:
  /// As Sources::prepare(). Context: setup.
  void prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<Task> tasks,
               std::span<TaskMemory> memories, const PeerView* others, bool preemptive, SetupMemory& memory);

  Source source_from(const PortOf& producer) const noexcept;
  /// The group of the source, in place or in another context; not bound: it is not there yet.
  GroupReader reader_of(const Source& source) const noexcept;
  /// The copy of the source's group for the task. Requires: it reads a variable of that group, produced elsewhere.
  LocalGroup& of(TaskId consumer, const Source& source) noexcept { return find(consumer, source)->group; }
  /// The task has a copy of a group of the producer.
  bool has(TaskId consumer, TaskId producer) const noexcept;

  /// Copies of producers that are ON, and of the operator, follow their present groups. Those of others keep what they
  /// have: a restarted process shows a group without values before its tasks are ON again.
  void follow(TaskId consumer) noexcept;
  /// The copy of that source follows the present group whatever the state of the producer. No effect without a copy.
  void follow_now(TaskId consumer, const Source& source) noexcept;
  /// What was read from groups of the producer (invalid: the operator) is not read any more, and kept.
  void let_go(TaskId producer) noexcept;
  /// The producer has new groups: what was kept of it is not worth keeping.
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

  bool is_mine(TaskId task) const noexcept { return memories_[task.index].is_planned(); }
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

}  // namespace chimera
