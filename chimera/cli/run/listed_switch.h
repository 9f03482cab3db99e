// SPDX-License-Identifier: Apache-2.0
// An act of `--at` that switches tasks by name: `switch --on A --off B`. A run in this process asks it at its instant.
#pragma once

#include <string>
#include <vector>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/asked_tasks.h"

namespace chimera::cli {

/// The tasks that `switch` names: those after `--on`, and those after `--off`.
struct TaskLists {
  std::vector<TaskId> plus, minus;
};

/// What the manager makes of the same words (hosted/asked_set.h). Remembers why nothing was switched.
class ListedSwitch final : public AskedTasks {
 public:
  /// `text`: the act as its user wrote it. The spec outlives this.
  ListedSwitch(const ApplicationSpec& spec, TaskLists lists, std::string text)
      : spec_(spec), lists_(std::move(lists)), text_(std::move(text)) {}

  bool find(const TaskBits& on, Nanoseconds now, TaskBits& target) override;
  /// When it was refused, on the executor's clock; kNever: it was not. Context: setup.
  Nanoseconds refused_at() const noexcept { return refused_at_; }
  /// "refused at 0.200 s: switch --on pid: u would have two producers: pid and lqr" and a line end; "": it was not.
  /// Context: setup.
  std::string refusal(Nanoseconds origin) const;

 private:
  const ApplicationSpec& spec_;
  TaskLists lists_;
  std::string text_, why_;
  Nanoseconds refused_at_ = kNever;
};

}  // namespace chimera::cli
