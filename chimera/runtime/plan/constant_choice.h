// SPDX-License-Identifier: Apache-2.0
// Chooses the producer of a constant for a task, where several tasks produce it in different configurations: the one of
// the configuration whose constants are in force; for a task outside it that of the first configuration that names the
// task. Also lists the tasks to re-initialise when the constants of another configuration come into force.
// docs/decisions/0061-a-slow-switch.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/switch_plan.h"

namespace chimera {

/// The configuration that is the start set; kNoSet: none is. Context: any; O(sets * tasks).
std::uint32_t set_of_start(const ApplicationSpec& spec) noexcept;

/// Place in ConstantSpec::producers of the one that counts for `user` while the constants of sets[in_force] are in
/// force; 0 where there is only one, or none. Context: cycle boundary; O(sets * tasks).
std::uint32_t producer_for(const ApplicationSpec& spec, ConstantId constant, TaskId user,
                           std::uint32_t in_force) noexcept;

/// The values that producers have made. They decide whether a switch must be slow.
class MadeConstants {
 public:
  /// True if producers `a` and `b` of the constant made different values, or one is not known. Context: cycle boundary.
  virtual bool differ(ConstantId constant, std::uint32_t a, std::uint32_t b) const noexcept = 0;

 protected:
  ~MadeConstants() = default;
};

/// Holds one answer at a time. Context of everything not marked: cycle boundary; O(tasks * ports * sets); no
/// allocation.
class ConstantUsers {
 public:
  /// The spec outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);
  /// Some constant has several producers: without, no switch changes a constant.
  bool is_any() const noexcept { return !users_.empty(); }

  /// Tasks of the plan's new set whose constants may change when the constants of that set replace those of
  /// sets[before]: in the order of initialisation. `made` null: whatever the values are, arriving tasks included.
  std::span<const TaskId> find(const SwitchPlan& plan, std::uint32_t before, const MadeConstants* made) noexcept;
  /// A task of find() that stays ON, with a constant that changes for it; invalid: none.
  struct Found {
    TaskId task;
    ConstantId constant;
  };
  Found find_staying(const SwitchPlan& plan, std::uint32_t before, const MadeConstants& made) noexcept;
  /// The constant may change for `user`. Requires: find() was just called with the same arguments.
  bool is_another(ConstantId constant, TaskId user, const SwitchPlan& plan, std::uint32_t before,
                  const MadeConstants* made) const noexcept;

 private:
  ConstantId changed(TaskId user, const SwitchPlan& plan, std::uint32_t before,
                     const MadeConstants* made) const noexcept;

  const ApplicationSpec* spec_ = nullptr;
  std::span<TaskId> users_;   // as many as there are tasks; empty: no constant has several producers
  std::span<bool> is_user_;   // by task
};

}  // namespace chimera
