// SPDX-License-Identifier: Apache-2.0
// Compares the times of all tasks with the tick of the target.
#include <algorithm>
#include <numeric>

#include "chimera/bake/refusals.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/text/time_text.h"

namespace chimera::bake {
namespace {

constexpr Nanoseconds kShortestTick = microseconds(50);  // an advice; a shorter tick costs too much of a small core

/// "333.333333 Hz", exact to the nanosecond of its period.
std::string rate_text(Nanoseconds period) {
  return formatted("%.9g Hz", 1e9 / static_cast<double>(period.count));
}

/// The whole number of ticks, at least one, that is nearest to `time`.
Nanoseconds nearest_ticks(Nanoseconds time, Nanoseconds tick) {
  return tick * std::max<std::int64_t>(1, (time.count + tick.count / 2) / tick.count);
}

class Times {
 public:
  Times(Nanoseconds tick, Report& report) : tick_(tick), report_(report) {}

  void judge(const TaskSpec& task, const DraftTask& draft) {
    const Place rate_at = draft.rate ? draft.rate->at : draft.name.at;
    const Nanoseconds near = nearest_ticks(task.period, tick_);
    refuse("period", task.period, rate_at, draft, "write 'rate: " + rate_text(near) + "', a period of " +
           time_text(near));
    refuse("offset", task.offset, draft.offset ? draft.offset->at : rate_at, draft,
           "write 'offset: " + time_text(nearest_ticks(task.offset, tick_)) + "'");
    if (task.deadline != task.period)
      refuse("deadline", task.deadline, draft.deadline ? draft.deadline->at : rate_at, draft,
             "write 'deadline: " + time_text(nearest_ticks(task.deadline, tick_)) + "'");
  }

 private:
  void refuse(const char* what, Nanoseconds time, Place at, const DraftTask& draft, std::string remedy) {
    if (time.count % tick_.count == 0) return;
    const Nanoseconds finer{std::gcd(time.count, tick_.count)};
    if (finer >= kShortestTick) remedy += ", or 'tick: " + time_text(finer) + "' in the target";
    report_.add({.rule = "time-range",
                 .at = at,
                 .message = "the " + std::string(what) + " of task " + in_quotes(draft.name.text) + " is " +
                            time_text(time) + ", which is no multiple of the tick of " + time_text(tick_),
                 .found = time_text(time),
                 .expected = "a multiple of " + time_text(tick_),
                 .remedy = std::move(remedy)});
  }

  Nanoseconds tick_;
  Report& report_;
};

}  // namespace

void refuse_times(const Configuration& configuration, const Target& target, Report& report) {
  Times times(target.tick.value, report);
  for (std::size_t t = 0; t < configuration.tasks().size(); ++t)
    if (!configuration.draft().tasks[t].server)
      times.judge(configuration.spec().tasks[t], configuration.draft().tasks[t]);
}

}  // namespace chimera::bake
