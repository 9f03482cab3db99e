// SPDX-License-Identifier: Apache-2.0
// Where every group of a peer lies. All processes compute it from the same specs, so no message carries it.
// docs/formats/processes.md, "Groups of an rtpu's segment".
#pragma once

#include <span>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/table/layout.h"

namespace chimera {

/// Payload of a task's fault group: a FaultRecord as it lies in memory.
inline constexpr std::string_view kFaultVariable = "fault";

/// The plan of one peer's groups, in memory that it is given. Copyable; immutable.
/// Context of making: setup; of reading: any, wait-free.
class PeerLayout {
 public:
  /// Layout of rtpu number `peer`, or of the manager if `peer` is the number of rtpus. Fails where TableLayout fails.
  static Result<PeerLayout> of(const ApplicationSpec& spec, std::uint32_t peer, SetupMemory& memory);
  /// Layout of all tasks and all operator variables together: a single context without other processes.
  static Result<PeerLayout> of_everything(const ApplicationSpec& spec, SetupMemory& memory);

  const TableLayout& table() const noexcept { return table_; }
  bool has(TaskId task) const noexcept { return first_group_[task.index] != UINT32_MAX; }
  /// The groups of a task of this peer. `half` is the incarnation modulo 2. Requires: has(task).
  GroupId outputs(TaskId task, std::uint32_t half) const noexcept {
    return GroupId(first_group_[task.index] + half % 2);
  }
  GroupId constants(TaskId task) const noexcept { return GroupId(first_group_[task.index] + 2); }
  GroupId fault(TaskId task) const noexcept { return GroupId(first_group_[task.index] + 3); }
  /// The group of operator variable `index` of the specs. Only in the layout of the manager.
  GroupId operator_group(std::size_t index) const noexcept { return GroupId(first_operator_ + index); }

  const GroupPlace& place(GroupId group) const noexcept { return table_.group(group); }
  /// Places of the variables of a group, in the order of the task's ports of that kind.
  std::span<const VariablePlace> variables(GroupId group) const noexcept;

 private:
  static Result<PeerLayout> make(const ApplicationSpec& spec, bool everything, std::uint32_t peer, SetupMemory& memory);

  TableLayout table_;
  std::span<std::uint32_t> first_group_;  // by task
  std::size_t first_operator_ = 0;
};

}  // namespace chimera
