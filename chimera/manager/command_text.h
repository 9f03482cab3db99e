// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "chimera/runtime/application_spec.h"
#include "chimera/task/signal.h"

namespace chimera::manager {

/// "off pid, arm", "ring lamp". Context: setup.
inline std::string command_text(const ApplicationSpec& spec, Signal signal, std::span<const TaskId> tasks) {
  std::string text = signal == Signal::kWakeup ? "ring" : signal_name(signal);
  for (std::size_t i = 0; i < tasks.size(); ++i)
    text += (i == 0 ? " " : ", ") + std::string(spec.tasks[tasks[i].index].name);
  return text;
}

}  // namespace chimera::manager
