// SPDX-License-Identifier: Apache-2.0
// Reports connections that ControlServer closed. Many closings of one user share one sentence, so that they do not push
// everything else out of the log.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "chimera/control/allowance.h"
#include "chimera/platform/process_state.h"

namespace chimera::control {

/// Context: setup.
class Closings {
 public:
  using Tell = std::function<void(const std::string&)>;

  void report_to(Tell tell) { tell_ = std::move(tell); }
  /// The first sixteen closings of a user are reported at once, then one in 10 s, with the number of the others.
  void add(uid_t user, std::string text, Nanoseconds now);
  /// Reports the waiting closings that are due.
  void report_due(Nanoseconds now);
  /// Time at which report_due() has a report; kNever: nothing waits.
  Nanoseconds next_due() const noexcept;

 private:
  struct OfUser {
    Allowance at_once{seconds(10), 16};
    std::uint64_t untold = 0;
    std::string last = {};
    Nanoseconds due = kNever;
  };
  void report_due(OfUser& one, Nanoseconds now);

  Tell tell_;
  std::map<uid_t, OfUser> users_;  // only users with a role: few
};

}  // namespace chimera::control
