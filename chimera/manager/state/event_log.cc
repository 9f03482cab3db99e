// SPDX-License-Identifier: Apache-2.0
// Numbers events, keeps the last ten thousand, and gives them out.
#include "chimera/manager/state/event_log.h"

#include <utility>

namespace chimera::manager {

void EventLog::add(LoggedEvent event) {
  event.number = ++last_;
  kept_.push_back(std::move(event));
  if (kept_.size() > kEventsKept) kept_.pop_front();
}

void EventLog::recall(std::vector<LoggedEvent> older) {
  for (; !older.empty() && kept_.size() < kEventsKept; older.pop_back())
    if (older.back().number + 1 == first()) kept_.push_front(std::move(older.back()));
    else if (older.back().number < first()) return;
}

}  // namespace chimera::manager
