// SPDX-License-Identifier: Apache-2.0
// Actions of an operator, written down with times: signals, the illegal-configuration flag, values of operator
// variables, switches of configurations. Tests and `run` hand one to an executor, which acts at the first cycle
// boundary at or after each time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/assert.h"
#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/runtime/plan/switch_request.h"
#include "chimera/task/signal.h"

namespace chimera {

/// One act. `at` counts from the start of the run.
struct ScriptAct {
  enum class Kind : std::uint8_t { kSignal, kRaiseFlag, kLowerFlag, kSet, kSwitch, kDie };

  Nanoseconds at;
  Kind kind = Kind::kSignal;
  Signal signal = Signal::kOn;  ///< kSignal only
  TaskId task;                  ///< kSignal only
  std::size_t operator_index = 0;         ///< kSet only: in ApplicationSpec::operators
  std::span<const std::byte> value = {};  ///< kSet only: as long as the value that the description gives
  std::uint32_t set = UINT32_MAX;         ///< kSwitch only: in ApplicationSpec::sets
  const TaskLists* lists = nullptr;       ///< kSwitch only: in place of `set`
  RtpuId rtpu = {};                       ///< kDie only, which no single context can carry out: virtual/virtual_rtpus.h

  /// The request of a kSwitch act. Context: any; wait-free.
  SwitchRequest request() const noexcept {
    return {set, SwitchCause::kScript, {}, lists != nullptr ? *lists : TaskLists()};
  }
};

/// Acts in order of time, those of one instant in the given order. The memory outlives the script.
class Script {
 public:
  Script() noexcept = default;
  /// Requires: sorted by `at`. Context: setup.
  explicit Script(std::span<const ScriptAct> acts) noexcept : acts_(acts) {
    for (std::size_t i = 1; i < acts.size(); ++i) CHIMERA_ASSERT(acts[i - 1].at <= acts[i].at);
  }

  /// How many acts there are. Context: setup.
  std::size_t size() const noexcept { return acts_.size(); }
  /// How many acts there are of that kind. Context: setup.
  std::size_t count(ScriptAct::Kind kind) const noexcept {
    std::size_t n = 0;
    for (const ScriptAct& act : acts_) n += act.kind == kind ? 1 : 0;
    return n;
  }
  /// When the next act is due; kNever after the last. Context: cycle; wait-free.
  Nanoseconds next_at() const noexcept { return done_ < acts_.size() ? acts_[done_].at : kNever; }
  /// The next act that is due at `since_start`, once; null when none is. Context: cycle boundary; wait-free.
  const ScriptAct* take(Nanoseconds since_start) noexcept {
    return next_at() <= since_start ? &acts_[done_++] : nullptr;
  }

 private:
  std::span<const ScriptAct> acts_;
  std::size_t done_ = 0;
};

}  // namespace chimera
