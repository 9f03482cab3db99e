// SPDX-License-Identifier: Apache-2.0
// The reported profile of a task: its cost, its punctuality, its last fault. The JSON of docs/formats/run.md is written
// and read back only here.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chimera/analysis/transfer_cost.h"
#include "chimera/base/result.h"
#include "chimera/task/fault_record.h"
#include "chimera/task/profile.h"
#include "chimera/task/server_spec.h"
#include "chimera/task/state_machine.h"
#include "chimera/text/json.h"

namespace chimera {

/// Plain value.
struct TaskProfile {
  std::string task;
  std::string component;
  State state = State::kNotCreated;
  Nanoseconds period;
  Profile profile;
  FaultRecord faults;
  std::string rtpu;
  TransferCost transfer;  ///< of each cycle
  Nanoseconds on;         ///< time that it was ON
  std::optional<ServerSpec> server;
};

/// {"kind", "capacity_ns", "period_ns"}; null without a server. Context: setup.
Json server_json(const std::optional<ServerSpec>& server);
/// A JSON array with everything counted, one object a task, times in nanoseconds, of faults from `origin`.
/// Context: setup.
Json profile_json(std::span<const TaskProfile> tasks, Nanoseconds origin);

/// Reads such an array; `origin` as when it was written. A mean is read as a sum that gives it again. Refuses what is
/// no profile, naming the key. Context: setup.
Result<std::vector<TaskProfile>> read_profiles(const Json& json, Nanoseconds origin);

}  // namespace chimera
