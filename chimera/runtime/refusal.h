// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "chimera/base/time.h"

namespace chimera {

/// Why a signal was refused.
enum class Refusal : std::uint8_t {
  kNone,
  kState,       ///< not legal in the state of the task
  kIllegalSet,  ///< the tasks that would be ON would have two producers of a variable, or none
  kFault,       ///< `on` or the constructor said no; the text is in the task's fault record
  kNotYet,      ///< `on` answered not yet: it is to be asked again; the task is OFF
  kRival,       ///< of spawn: another task that is created has its resource (runtime/plan/rivals.h)
  kKeptOff,     ///< of on, sent by a task: an operator turned the task OFF
  kSwitch       ///< of on and spawn: a switch is under way (runtime/switch/switching.h)
};
inline constexpr Refusal kLastRefusal = Refusal::kSwitch;
/// A task whose `on` answers not yet is asked again for at most this time: a device may need seconds to start.
inline constexpr Nanoseconds kReadyLimit = seconds(10);

}  // namespace chimera
