// SPDX-License-Identifier: Apache-2.0
// Row 11: how soon after the end of its budget a job is seen to have used more. With a reaction that acts at once there
// is an exact timer; without, the next entry to the ceiling or the deadline finds it.
#include "bench/preemptive.h"

namespace chimera::bench {
namespace {

constexpr Nanoseconds kBudget = microseconds(300), kPeriod = milliseconds(2);

std::vector<double>* seen_after = nullptr;

// Computes until the host sets the give-up flag, and records the time from the end of its budget to that instant.
std::int32_t greedy_cycle(void*, const chimera_call* call) {
  const Nanoseconds begun = used_by_this_thread();
  const Nanoseconds most = kPeriod;
  while (call->host->expired(call->context) == 0 && used_by_this_thread() - begun < most) {
  }
  const Nanoseconds late = used_by_this_thread() - begun - kBudget;
  if (seen_after->size() < seen_after->capacity()) seen_after->push_back(static_cast<double>(late.count));
  return CHIMERA_ABORTED;
}

void run(int repetitions) {
  static const chimera_component component = [] {
    chimera_component c = axis_component();
    c.methods[CHIMERA_CYCLE] = greedy_cycle;
    return c;
  }();
  std::vector<double> late;
  late.reserve(100'000);
  seen_after = &late;
  for (int i = 0; i < repetitions; ++i) {
    AxesForm form;
    form.preemptive = true;
    form.budget = kBudget;
    form.component = &component;
    form.on_overrun = OnMiss::kAbort;
    Axes axes(1, [](std::uint32_t) { return kPeriod; }, form);
    with_executor(axes, Policy::kEdf, [](PreemptiveExecutor& executor) { (void)executor.run(milliseconds(600)); });
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(200));
  }
  for (const auto& [part, name, goal] :
       {std::tuple{0.5, "p50", Goal{}}, std::tuple{0.99, "p99", figure_at_most(50'000)}}) {
    Figure f{.row = 11, .what = std::string("overrun seen after the end of the budget, exact timer, ") + name,
             .unit = "ns", .goal = goal};
    f.figure = quantile(late, part);
    f.n = late.size();
    print(f);
  }
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) { chimera::bench::run(chimera::bench::repetitions(argc, argv, 9)); }
