// SPDX-License-Identifier: Apache-2.0
// The events of a subsystem, numbered without a gap from its start, over every restart of the manager. The log keeps
// the last 10,000, also those of dead managers; a client that asks for older events learns how many are gone.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"

namespace chimera::manager {

/// One entry. `kind` as in docs/formats/control.md.
struct LoggedEvent {
  std::uint64_t number = 0;
  Nanoseconds at;             ///< CLOCK_MONOTONIC
  std::int64_t wall_ns = 0;   ///< since 1970
  std::string kind;
  TaskId task;                ///< invalid: none
  RtpuId rtpu;                ///< invalid: none
  std::string text;
  std::string by;             ///< role and user of the request that caused it: "operate:ann"; "": no request did
};

inline constexpr std::size_t kEventsKept = 10'000;

/// Single-threaded. Context: setup; may allocate.
class EventLog {
 public:
  /// Continues after number `last`, which a predecessor used.
  explicit EventLog(std::uint64_t last = 0) noexcept : last_(last) {}

  /// Adds an event under the next number; ignores `event.number`.
  void add(LoggedEvent event);
  /// Puts events of dead managers before those kept: the ones without a gap up to first(). Requires: `older` ascends.
  void recall(std::vector<LoggedEvent> older);
  /// Number of the oldest event kept, last() + 1 when there is none; and of the newest, 0 before the first.
  std::uint64_t first() const noexcept { return last_ - kept_.size() + 1; }
  std::uint64_t last() const noexcept { return last_; }
  /// Requires: first() <= number <= last().
  const LoggedEvent& at(std::uint64_t number) const noexcept { return kept_[number - first()]; }

 private:
  std::deque<LoggedEvent> kept_;
  std::uint64_t last_;
};

}  // namespace chimera::manager
