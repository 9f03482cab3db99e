// SPDX-License-Identifier: Apache-2.0
// A request for a switch: its target configuration or task lists, and its cause.
#pragma once

#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/task_lists.h"

namespace chimera {

/// Cause of a request for a switch.
enum class SwitchCause : std::uint8_t {
  kScript,   ///< an act of the script
  kRequest,  ///< a method of the task `by` asked: Cycle::request()
  kMiss,     ///< the reaction `on_miss` of the task `by`
  kOverrun,  ///< its reaction `on_overrun`
  kFault,    ///< its reaction `on_fault`
  kStandby,  ///< no request: the standby `by` takes over, which is no switch and has a receipt all the same
};

/// Names a configuration, or with `lists` tasks.
struct SwitchRequest {
  std::uint32_t set = UINT32_MAX;  ///< in ApplicationSpec::sets
  SwitchCause cause = SwitchCause::kScript;
  TaskId by;  ///< invalid where `cause` is kScript
  TaskLists lists{};

  explicit operator bool() const noexcept { return set != UINT32_MAX || lists.are_there(); }
  /// True if both requests have the same target, whatever their causes.
  bool is_for(const SwitchRequest& other) const noexcept { return set == other.set && lists == other.lists; }
};

/// Finds the target set of a request with lists, which depends on the tasks that are ON then.
class AskedTasks {
 public:
  virtual ~AskedTasks() = default;
  /// Writes the tasks that are to be ON after the lists are applied to `on`. False: they are no legal set, and nothing
  /// is switched. `now` is on the executor's clock. Context: cycle boundary; may allocate.
  virtual bool find(const SwitchRequest& request, const TaskBits& on, Nanoseconds now, TaskBits& target) = 0;
};

}  // namespace chimera
