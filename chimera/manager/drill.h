// SPDX-License-Identifier: Apache-2.0
// A drill: the illegal-configuration flag goes up while the machine runs, and each hardware task that is ON has to say
// by its `safe_state` output that its device is in the state that the flag asks for.
// docs/design/guard.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

/// What a drill found out about one hardware task.
enum class DrillVerdict : std::uint8_t {
  kWaiting,    ///< ON, and has not said that it is safe
  kSafe,
  kLeft,       ///< went out of service before it said so
  kCannotTell  ///< its component has no output that could say so
};

/// "waiting", "safe", "left", "cannot-tell".
const char* verdict_word(DrillVerdict verdict) noexcept;

struct DrillPart {
  TaskId task;
  std::uint32_t output = 0;  ///< that says so, among its out-vars; without a meaning for kCannotTell
  DrillVerdict verdict = DrillVerdict::kWaiting;
  std::uint32_t incarnation = 0;  ///< of its real-time unit when the drill began
  Nanoseconds after{};       ///< of kSafe: from the flag to the publication that was seen to say so
};

/// A real-time unit that was killed for a drill, and what the guard did then.
struct DrillKill {
  RtpuId rtpu;                 ///< invalid: none was
  bool is_told = false;        ///< by the guard
  std::uint32_t good = 0, bad = 0;
  Nanoseconds after{};         ///< from the kill to the last byte of the last frame
};

struct DrillOutcome {
  std::vector<DrillPart> tasks;  ///< in the order of the description
  DrillKill killed;
  Nanoseconds flag_for;          ///< how long the flag was up for it
  /// Every hardware task that is ON said so, and there is one; and of a unit that was killed all frames were written,
  /// and there was one.
  bool is_safe() const noexcept;
};
using Drilled = std::function<void(const DrillOutcome&)>;

/// The hardware tasks of an application: those with a `safe_state` output, and those with a resource port that is not
/// declared `safe_state`, because something of it may move. `verdict` is kWaiting or kCannotTell. Context: setup.
std::vector<DrillPart> hardware_of(const ApplicationSpec& spec, const Library& library);

/// One drill at a time. Context: setup; never blocks.
class Drill {
 public:
  /// `end_unit`: has a unit killed. Everything outlives it.
  Drill(ManagerState& world, std::function<void(RtpuId)> end_unit);
  Drill(const Drill&) = delete;
  Drill& operator=(const Drill&) = delete;

  /// Raises the flag. `drilled` is called when every hardware task is safe, has left or cannot tell, or when `wait` is
  /// over, maybe at once; the flag is down again then. Requires: !is_under_way().
  /// `to_kill`: a unit that is killed when all are safe, or invalid; then it goes on until the guard has told what it
  /// wrote, once more for `wait` at most.
  void begin(Nanoseconds wait, RtpuId to_kill, Nanoseconds now, Drilled drilled);
  bool is_under_way() const noexcept { return present_.has_value(); }

  /// What the guard wrote.
  void take(const KeeperMessage& written);
  /// Looks at what the tasks have published since.
  void look(Nanoseconds now);
  /// When look() is due though nobody says anything; kNever: not.
  Nanoseconds next_due() const noexcept { return present_ ? due_ : kNever; }

 private:
  struct Present {
    DrillOutcome outcome;
    Nanoseconds raised, until, wait;
    Drilled drilled;
    RtpuId to_kill;
    Nanoseconds killed_at{};
  };
  void show_flag(bool up);
  void judge(DrillPart& part) const;
  bool goes_on(Nanoseconds now);
  void tell(const DrillOutcome& outcome, Nanoseconds now);

  ManagerState& world_;
  std::function<void(RtpuId)> end_unit_;
  std::vector<DrillPart> hardware_;
  std::optional<Present> present_;
  Nanoseconds due_ = kNever;
};

}  // namespace chimera::manager
