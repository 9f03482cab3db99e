// SPDX-License-Identifier: Apache-2.0
// Where the groups of one context lie: outputs and constants of its tasks, and the operator variables of a context that
// holds them itself; in memory taken at setup, or in bytes that others map too.
#pragma once

#include <cstddef>
#include <span>

#include "chimera/base/result.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/state/context_place.h"
#include "chimera/runtime/state/peer_layout.h"
#include "chimera/runtime/state/task_memory.h"
#include "chimera/runtime/state/variable_view.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; wait-free.
class ContextTable {
 public:
  /// Lays out the groups of the application and, of these, the groups of `place.rtpu`, in `place.table`. Operator
  /// variables are this context's where it is alone (they are the manager's otherwise), and are published with their
  /// initial values. Refuses what PeerLayout refuses. The spec and the given bytes outlive this. A context that never
  /// has others, and whose tasks read each other in place, needs no layout: each task places its own outputs. Context:
  /// setup.
  Result<void> prepare(const ApplicationSpec& spec, const ContextPlace& place, SetupMemory& memory);
  /// Gives a task of this context its two groups of outputs. Context: setup.
  void place_outputs(TaskId task, TaskMemory& its, SetupMemory& memory) const;

  /// The plan of all groups of the application, of other contexts too.
  const PeerLayout& everything() const noexcept { return everything_; }
  /// The group of the operator variables, by their index in the spec; empty where they are not this context's.
  std::span<const GroupReader> operators() const noexcept { return operators_; }
  /// Publishes a value of operator variable `index`; its readers see it as not valid if `valid` is false. Requires:
  /// operators() has it; as many bytes as the description gives.
  void set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now, bool valid = true) noexcept;

  /// Places of the constants of a task of this context, in the order of its ports of that kind.
  std::span<const VariablePlace> constant_places(TaskId task) const noexcept {
    return own_.variables(own_.constants(task));
  }
  /// The group of the constants of a task of this context.
  GroupReader constants_of(TaskId task) const noexcept { return reader(own_.constants(task)); }
  /// Writes the constants of a task of this context, from where the last writer stopped. Requires: it has some.
  GroupWriter constant_writer(TaskId task) const noexcept { return writer(own_.constants(task)); }

  /// The group of outputs in which a value of an out-var may stand: `half` 0 or 1, used in turn by the incarnations of
  /// its task, of this context. For readers in other threads, who take the latest publication.
  VariableReader reader_of(const PortOf& producer, std::uint32_t half) const noexcept;

 private:
  void prepare_alone(const ApplicationSpec& spec, SetupMemory& memory);
  std::span<std::byte> group(GroupId group) const noexcept;
  GroupWriter writer(GroupId id) const noexcept { return GroupWriter(group(id), own_.place(id).payload_bytes); }
  GroupReader reader(GroupId id) const noexcept {
    return GroupReader(group(id).data(), own_.place(id).payload_bytes);
  }

  PeerLayout everything_, own_;  // own_: of the groups of this context
  std::span<std::byte> table_;
  std::span<std::span<std::byte>> own_operators_;  // their groups, where there is no layout
  std::span<GroupReader> operators_;
};

}  // namespace chimera
