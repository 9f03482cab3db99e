// SPDX-License-Identifier: Apache-2.0
// Gives the kinds of refusal their names, and keeps the first reason of several refusals.
#include "chimera/subsystem/signal_refusal.h"

#include <utility>

namespace chimera::subsystem {

const char* refusal_kind_name(RefusalKind kind) noexcept {
  constexpr const char* kNames[] = {"",         "state",     "set",       "fault",     "ended",
                                    "resource", "not-ready", "no-answer", "overtaken", "other"};
  return kNames[static_cast<unsigned>(kind)];
}

SignalRefusal SignalRefusal::behind(const std::string& words) const {
  return {kind, reason.empty() ? reason : words + reason, remedy, tasks};
}

bool SignalRefusal::add(SignalRefusal later) {
  if (is_refused() && (!reason.empty() || later.reason.empty())) return false;
  *this = std::move(later);
  return true;
}

}  // namespace chimera::subsystem
