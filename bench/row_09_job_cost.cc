// SPDX-License-Identifier: Apache-2.0
// Row 9: processor time and switches a job of preemptive scheduling by labels, against a thread for each task at a
// fixed priority and against a dispatcher thread; in turn, ratios inside each repetition. The limit: threads that only
// change their level twice a job.
#include <functional>

#include "bench/preemptive.h"

namespace chimera::bench {
namespace {

constexpr Nanoseconds kTime = milliseconds(300), kRest = milliseconds(60);

struct Ratios {
  std::vector<double> ours, other, ratio, limit;
  void add(double a, double b) {
    ours.push_back(a);
    other.push_back(b);
    ratio.push_back(a / b);
  }
  Figure figure(std::string what, std::string baseline, std::string unit, Goal goal) const {
    Figure f{.row = 9, .what = std::move(what), .unit = std::move(unit), .goal = goal};
    f.figure = median(ours);
    f.baseline = median(other);
    f.baseline_name = std::move(baseline);
    f.ratio = median(ratio);
    if (!limit.empty()) f.limit = median(limit);
    f.n = ours.size();
    return f;
  }
};

void rest() { (void)LinuxClock().wait_until(LinuxClock().now() + kRest); }

void compare(const Load& load, const char* name, int repetitions, double most_fixed, Goal dispatched_goal,
             double most_switches) {
  Ratios to_fixed, to_dispatched, supervised, control;
  std::vector<double> switches, changes;
  for (int i = 0; i < repetitions; ++i) {
    const Cost fixed = run_fixed(load, kTime);
    rest();
    const Cost lowered = run_lowered(load, kTime);
    rest();
    const Cost ours = run_ours(load, Policy::kEdf, kTime);
    rest();
    const Cost dispatched = run_dispatched(load, kTime);
    rest();
    const Cost with_budgets = run_ours(load, Policy::kEdf, kTime, load.period);
    rest();
    const Cost again = run_fixed(load, kTime);
    rest();
    to_fixed.add(ours.cpu_ns, fixed.cpu_ns);
    to_dispatched.add(ours.cpu_ns, dispatched.cpu_ns);
    to_fixed.limit.push_back(lowered.cpu_ns);
    to_dispatched.limit.push_back(lowered.cpu_ns);
    supervised.add(with_budgets.cpu_ns, ours.cpu_ns);
    control.add(again.cpu_ns, fixed.cpu_ns);
    switches.push_back(ours.switches);
    changes.push_back(ours.level_changes);
  }
  const std::string jobs = std::to_string(load.n) + " tasks of " + std::to_string(load.period.count / 1'000'000) +
                           " ms, " + name;
  Figure f = to_fixed.figure("CPU a job, " + jobs, "fixed priorities", "ns", ratio_at_most(most_fixed));
  f.aa_spread = std::abs(median(control.ratio) - 1);
  print(f);
  print(to_dispatched.figure("CPU a job, " + jobs, "dispatcher thread", "ns", dispatched_goal));
  print(supervised.figure("CPU a job with budgets, " + jobs, "without", "ns", ratio_at_most(1.3)));
  Figure s{.row = 9, .what = "switches a job, " + jobs, .unit = "switches", .goal = figure_at_most(most_switches)};
  s.figure = median(switches);
  s.n = switches.size();
  print(s);
  if (load.staggered) return;
  Figure c{.row = 9, .what = "priority changes of others a job, " + jobs, .unit = "changes", .goal = figure_at_most(4)};
  c.figure = median(changes);
  c.n = changes.size();
  print(c);
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera;
  using namespace chimera::bench;
  const int n = repetitions(argc, argv, 9);
  compare({10, milliseconds(1), true}, "staggered", n, 1.6, ratio_at_most(0.5), 1.05);
  compare({10, milliseconds(1), false}, "at one instant", n, 3.0, ratio_at_most(0.7), 2.1);
  // Reported against the dispatcher: docs/design/preemptive.md.
  compare({200, milliseconds(20), false}, "all at one instant", std::max(3, n / 3), 3.0, {}, 2.1);
}
