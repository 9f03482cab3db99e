// SPDX-License-Identifier: Apache-2.0
// Counts closed connections by user and limits the rate of reports about each user.
#include "chimera/control/closings.h"

#include <algorithm>

namespace chimera::control {

void Closings::add(uid_t user, std::string text, Nanoseconds now) {
  OfUser& one = users_[user];
  ++one.untold;
  one.last = std::move(text);
  report_due(one, now);
}

void Closings::report_due(Nanoseconds now) {
  for (auto& [user, one] : users_) report_due(one, now);
}

void Closings::report_due(OfUser& one, Nanoseconds now) {
  if (one.untold == 0) return;
  if (!one.at_once.try_take(now)) {
    one.due = now + one.at_once.wait(now);
    return;
  }
  const std::string others = one.untold == 1 ? "" : std::to_string(one.untold) + " connections were closed; the last: ";
  one.due = kNever;
  one.untold = 0;
  if (tell_) tell_(others + one.last);
}

Nanoseconds Closings::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const auto& [user, one] : users_) next = std::min(next, one.due);
  return next;
}

}  // namespace chimera::control
