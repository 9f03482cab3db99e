// SPDX-License-Identifier: Apache-2.0
// The constants of one context: passed from tasks that make them to tasks that are initialised with them. Constants of
// other contexts are read from the groups that those publish.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/fixed.h"
#include "chimera/base/mechanisms.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/plan/constant_choice.h"
#include "chimera/runtime/state/constant_store.h"
#include "chimera/runtime/state/context_table.h"
#include "chimera/runtime/state/peer_view.h"
#include "chimera/runtime/state/task_memory.h"
#include "chimera/task/task.h"

namespace chimera {

/// If several tasks produce a constant, the configuration in force selects one: at first the configuration that is the
/// start set. Context of everything not marked: cycle boundary; no allocation.
class ContextConstants final : public MadeConstants {
 public:
  /// `memories[t]` is planned for the tasks of this context and empty for those of others; `others` null: there are
  /// none. Everything given outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<TaskMemory> memories,
               const PeerView* others, SetupMemory& memory);

  /// Copies the present constants into the task and fixes its extents, before init or reinit. False with `why` if one
  /// has no value, an extent is out of range, or a list of values has another length than the constant says.
  bool give(TaskId task, FaultWords& why) noexcept;
  /// Takes over what init or reinit of the task made, fixes its extents, and shows the constants to other contexts.
  /// False with `why` as give().
  bool collect(TaskId task, FaultWords& why) noexcept;
  /// True if the last collect() brought a new value.
  bool has_new() const noexcept { return mechanisms::kConstants && has_new_; }
  /// True if a constant that the task was initialised with has a new value. Requires: it was constructed.
  bool uses_changed(TaskId task) noexcept;
  /// Some constant has several producers.
  bool has_choice() const noexcept { return mechanisms::kConstants && has_choice_; }
  /// From now on the constants of that configuration are in force. This re-initialises no task.
  void put_in_force(std::uint32_t set) noexcept { in_force_ = set; }
  /// kNoSet: no configuration of the application is its start set.
  std::uint32_t in_force() const noexcept { return in_force_; }
  /// True if the task could be initialised with the constants in force. As give(), but changes nothing.
  bool would_take(TaskId task, FaultWords& why) noexcept;
  /// Compares the values that were read last.
  bool differ(ConstantId constant, std::uint32_t a, std::uint32_t b) const noexcept override;
  /// Takes over what tasks of other contexts have made since. O(constants of others).
  void read_foreign() noexcept;

 private:
  struct Foreign {
    TaskId producer;
    ConstantId id;
    std::uint32_t offset = 0, bytes = 0;  // in the group of the producer's constants
  };

  void plan_foreign(SetupMemory& memory);
  void publish(TaskId task) noexcept;
  std::span<const std::uint32_t> listed(const PortSpec& port) const noexcept;
  bool lists_fit(TaskId task, FaultWords& why) const noexcept;
  void choose_for(TaskId task) noexcept;

  const ApplicationSpec* spec_ = nullptr;
  const ContextTable* table_ = nullptr;
  std::span<TaskMemory> memories_;
  const PeerView* others_ = nullptr;
  ConstantStore store_;
  std::span<Foreign> foreign_;
  std::span<std::byte> scratch_;  // a payload of the largest group of foreign constants
  std::uint32_t in_force_ = kNoSet;
  bool has_choice_ = false;  // some constant has several producers
  bool has_new_ = false;
};

}  // namespace chimera
