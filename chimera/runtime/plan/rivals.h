// SPDX-License-Identifier: Apache-2.0
// Finds the tasks that open the same resource, so that only one of them can be created at a time. Two tasks are rivals
// if each has a resource port with the same text, neither port is declared `shared`, and no configuration names both: a
// configuration with both says that the device allows it. docs/design/switch.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Context of everything not marked: any; wait-free.
class Rivals {
 public:
  /// The spec outlives this. Context: setup; O(tasks^2 * ports^2) over the tasks with resources.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);
  bool is_any() const noexcept { return mechanisms::kRivals && !pairs_.empty(); }
  /// O(pairs).
  bool are(TaskId a, TaskId b) const noexcept;
  /// The task has a rival, or uses a constant of a task that has one, or of such a one: while the rival is created, it
  /// may be NOT-CREATED although no signal has killed it.
  bool may_be_absent(TaskId task) const noexcept { return is_any() && may_be_absent_[task.index]; }
  /// The task is created at the start of a run: the start set, and who neither is a rival of one that is created before
  /// it nor needs a constant of a task that is not. O(tasks * (tasks + constants)).
  bool is_created_at_start(TaskId task) const noexcept { return !is_any() || is_created_at_start_[task.index]; }
  /// The resource that both have open; "": they are no rivals.
  std::string_view resource(TaskId a, TaskId b) const noexcept;

 private:
  struct Pair {
    TaskId a, b;
    std::string_view text;
  };
  void find_absent(const ApplicationSpec& spec) noexcept;
  void find_created(const ApplicationSpec& spec) noexcept;

  std::span<Pair> pairs_;
  std::span<bool> may_be_absent_, is_created_at_start_;  // by task; empty without pairs
};

}  // namespace chimera
