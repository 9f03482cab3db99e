// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/task/signal.h"

namespace chimera::manager {

inline constexpr std::size_t kTasksNamed = 16;  ///< of a command with more tasks

/// "off pid, arm", "ring lamp", "ring a, ..., p and 9984 more". Context: setup.
inline std::string command_text(const ApplicationSpec& spec, Signal signal, std::span<const TaskId> tasks) {
  const auto name = [&spec](TaskId task) { return spec.tasks[task.index].name; };
  const std::string word = signal == Signal::kWakeup ? "ring" : signal_name(signal);
  const std::string text = word + (tasks.empty() ? "" : " ") +
                           join(tasks.first(std::min(tasks.size(), kTasksNamed)), ", ", name);
  return tasks.size() <= kTasksNamed ? text : text + " and " + std::to_string(tasks.size() - kTasksNamed) + " more";
}

}  // namespace chimera::manager
