// SPDX-License-Identifier: Apache-2.0
// A drill: the illegal-configuration flag goes up while the machine runs. Each hardware task that is ON must report by
// its `safe_state` output that its device is in the state that the flag requires. docs/design/guard.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

/// Result of a drill for one hardware task.
enum class DrillVerdict : std::uint8_t {
  kWaiting,    ///< ON, and has not reported that it is safe
  kSafe,
  kLeft,       ///< left ON, or its rtpu died, before it reported that it is safe
  kCannotTell  ///< its component has no output that could report it
};

/// "waiting", "safe", "left", "cannot-tell".
const char* verdict_word(DrillVerdict verdict) noexcept;

struct DrillPart {
  TaskId task;
  std::uint32_t output = 0;  ///< index of its `safe_state` output among its out-vars; no meaning for kCannotTell
  DrillVerdict verdict = DrillVerdict::kWaiting;
  std::uint32_t incarnation = 0;  ///< incarnation of its rtpu when the drill began
  Nanoseconds after{};       ///< kSafe: time from the flag to the first publication that reports it
};

/// An rtpu that was killed for a drill, and the writes of the guard after that.
struct DrillKill {
  RtpuId rtpu;                 ///< invalid: no rtpu was killed
  bool is_told = false;        ///< the guard has reported its writes
  std::uint32_t good = 0, bad = 0;
  Nanoseconds after{};         ///< from the kill to the last byte of the last frame
};

struct DrillOutcome {
  std::vector<DrillPart> tasks;  ///< in the order of the description
  DrillKill killed;
  Nanoseconds flag_for;          ///< time for which the drill kept the flag up
  /// True if there is a hardware task and each one that is ON reported that it is safe. For a killed rtpu also: it had
  /// frames, and all were written.
  bool is_safe() const noexcept;
};
using Drilled = std::function<void(const DrillOutcome&)>;

/// The hardware tasks of an application: those with a `safe_state` output, and those with a resource port that is not
/// declared `safe_state`, because such a device may move. `verdict` is kWaiting or kCannotTell. Context: setup.
std::vector<DrillPart> hardware_of(const ApplicationSpec& spec, const Library& library);

/// One drill at a time. Context: setup; never blocks.
class Drill {
 public:
  /// `end_rtpu` has an rtpu killed. All arguments outlive it.
  Drill(ManagerState& state, std::function<void(RtpuId)> end_rtpu);
  Drill(const Drill&) = delete;
  Drill& operator=(const Drill&) = delete;

  /// Raises the flag. Calls `drilled` when every hardware task is safe, has left or cannot tell, or when `wait` is
  /// over, maybe at once; the flag is then down again. Requires: !is_under_way().
  /// `to_kill`: an rtpu that is killed when all are safe, or invalid. The drill then lasts until the guard has reported
  /// its writes, for another `wait` at most.
  void begin(Nanoseconds wait, RtpuId to_kill, Nanoseconds now, Drilled drilled);
  bool is_under_way() const noexcept { return present_.has_value(); }

  /// Notes the guard's report of its writes.
  void take(const KeeperMessage& written);
  /// Reads the publications of the tasks since the flag went up.
  void look(Nanoseconds now);
  /// Time when look() is due if no message arrives; kNever: not due.
  Nanoseconds next_due() const noexcept { return present_ ? due_ : kNever; }

 private:
  struct Present {
    DrillOutcome outcome;
    Nanoseconds raised, until, wait;
    Drilled drilled;
    RtpuId to_kill;
    std::string by;  ///< who asked for it
    Nanoseconds killed_at{};
  };
  void show_flag(bool up);
  void judge(DrillPart& part) const;
  bool goes_on(Nanoseconds now);
  void tell(const DrillOutcome& outcome, Nanoseconds now);

  ManagerState& state_;
  std::function<void(RtpuId)> end_rtpu_;
  std::vector<DrillPart> hardware_;
  std::optional<Present> present_;
  Nanoseconds due_ = kNever;
};

}  // namespace chimera::manager
