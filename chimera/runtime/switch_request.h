// SPDX-License-Identifier: Apache-2.0
// A request for a switch of configurations: which, and who asks.
#pragma once

#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/task/task.h"

namespace chimera {

/// Why a switch is asked for.
enum class SwitchCause : std::uint8_t {
  kScript,   ///< an act of the script
  kRequest,  ///< a method of the task `by` asked: Cycle::request()
};

/// `set` is in ApplicationSpec::sets.
struct SwitchRequest {
  std::uint32_t set = kNoRequest;
  SwitchCause cause = SwitchCause::kScript;
  TaskId by;  ///< invalid where `cause` is kScript

  explicit operator bool() const noexcept { return set != kNoRequest; }
};

}  // namespace chimera
