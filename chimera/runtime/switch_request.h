// SPDX-License-Identifier: Apache-2.0
// A request for a switch of configurations: which, and who asks.
#pragma once

#include <cstdint>

#include "chimera/base/ids.h"

namespace chimera {

/// Why a switch is asked for.
enum class SwitchCause : std::uint8_t {
  kScript,   ///< an act of the script
  kRequest,  ///< a method of the task `by` asked: Cycle::request()
  kMiss,     ///< the reaction `on_miss` of the task `by`
  kOverrun,  ///< its reaction `on_overrun`
  kFault,    ///< its reaction `on_fault`
  kStandby,  ///< nobody: `by` is a standby that takes over, which is no switch and has a receipt all the same
};

/// `set` is in ApplicationSpec::sets.
struct SwitchRequest {
  std::uint32_t set = UINT32_MAX;
  SwitchCause cause = SwitchCause::kScript;
  TaskId by;  ///< invalid where `cause` is kScript

  explicit operator bool() const noexcept { return set != UINT32_MAX; }
};

}  // namespace chimera
