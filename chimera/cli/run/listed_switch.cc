// SPDX-License-Identifier: Apache-2.0
// Works out the tasks of a switch by name when its instant has come.
#include "chimera/cli/run/listed_switch.h"

#include <cstdio>
#include <utility>

#include "chimera/cli/files/blanks.h"
#include "chimera/runtime/hosted/asked_set.h"

namespace chimera::cli {

bool ListedSwitch::find(const TaskBits& on, Nanoseconds now, TaskBits& target) {
  std::vector<bool> is_on(spec_.tasks.size());
  for (std::size_t t = 0; t < is_on.size(); ++t) is_on[t] = on.has(TaskId(t));
  const AskedSet asked = asked_set(spec_, std::move(is_on), lists_.plus, lists_.minus);
  target = asked.tasks;
  if (asked) return true;
  why_ = asked.why + (asked.remedy.empty() ? "" : "; " + asked.remedy);
  refused_at_ = now;
  return false;
}

std::string ListedSwitch::refusal(Nanoseconds origin) const {
  if (refused_at_ == kNever) return "";
  char at[32];
  std::snprintf(at, sizeof at, "%.3f s", to_seconds(refused_at_ - origin));
  return std::string("refused at ") + at + ": " + trimmed(text_.substr(text_.find(':') + 1)) + ": " + why_ + "\n";
}

}  // namespace chimera::cli
