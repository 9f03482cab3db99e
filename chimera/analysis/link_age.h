// SPDX-License-Identifier: Apache-2.0
// By how many periods a value is late when its reader runs: among jobs released together the reader runs behind the
// producer (0), or before it (1).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/application_spec.h"

namespace chimera {

/// A task that reads what another one writes.
struct TaskLink {
  TaskId from, to;
  std::string late;  ///< late_text()

  std::uint32_t periods() const noexcept { return late.empty() ? 0 : 1; }
};

/// The reason why `to` reads the value that `from` wrote a period before, and the remedy if there is one: "'b' runs on
/// another rtpu; remedy: rtpu: main of 'b'". Empty: it reads the value of its own period. Context of all: setup.
std::string late_text(const ApplicationSpec& spec, TaskId from, TaskId to);
/// Each pair of `tasks` that is linked, once, in the order of cycles.
std::vector<TaskLink> links_among(const ApplicationSpec& spec, std::span<const TaskId> tasks);
/// The tasks, all of one rtpu, in the order in which jobs released together run.
std::vector<TaskId> cycle_order(const ApplicationSpec& spec, std::vector<TaskId> tasks);

}  // namespace chimera
