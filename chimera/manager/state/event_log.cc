// SPDX-License-Identifier: Apache-2.0
// Numbers events, keeps the last ten thousand, and gives them out.
#include "chimera/manager/state/event_log.h"

namespace chimera::manager {

void EventLog::add(LoggedEvent event) {
  event.number = ++last_;
  kept_.push_back(std::move(event));
  if (kept_.size() > kEventsKept) kept_.pop_front();
}

}  // namespace chimera::manager
