// SPDX-License-Identifier: Apache-2.0
// Tells of connections that the door closed. A crowd of one user is told in one sentence, or it would push
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
  /// The first sixteen of a user are told at once, then one in 10 s, with the number of those that were not.
  void add(uid_t user, std::string text, Nanoseconds now);
  /// Tells of those that wait, when it is time.
  void report_due(Nanoseconds now);
  /// When report_due() has something to tell; kNever: nothing waits.
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
  std::map<uid_t, OfUser> users_;  // who has a role: few
};

}  // namespace chimera::control
