// SPDX-License-Identifier: Apache-2.0
// Row 14: cycles of virtual time per second of wall time.
#include "bench/bench.h"
#include "bench/tasks.h"
#include "chimera/runtime/virtual/virtual_executor.h"

namespace chimera::bench {
namespace {

class Candidate {
 public:
  Candidate(std::uint32_t n, bool preemptive)
      : axes_(n, [](std::uint32_t) { return milliseconds(1); }),
        executor_(axes_.set(), {}, how(preemptive)),
        periods_(n) {
    if (!executor_.start()) std::exit(1);
  }
  void run(std::uint64_t jobs) {
    until_ += milliseconds(periods_.of(jobs));
    executor_.run(until_);
  }

 private:
  static VirtualOptions how(bool preemptive) {
    VirtualOptions h;
    h.preemptive = preemptive;
    return h;
  }
  Axes axes_;
  VirtualExecutor executor_;
  Periods periods_;
  Nanoseconds until_;
};

void rate(const Comparison& c, std::size_t candidate, const char* what, Goal goal) {
  Figure figure{.row = 14, .what = what, .unit = "cycles/s", .goal = goal};
  figure.figure = 1e9 / c.cost(candidate);
  figure.aa_spread = c.aa_spread();
  figure.n = c.n();
  print(figure);
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera;
  using namespace chimera::bench;
  Stage stage;
  Candidate ten(10, false), thousand(1000, false), preemptive(10, true);
  Comparison c(repetitions(argc, argv));
  const auto run_10 = c.add("10 tasks", [&](std::uint64_t n) { ten.run(n); });
  const auto run_1000 = c.add("1000 tasks", [&](std::uint64_t n) { thousand.run(n); });
  const auto run_preemptive = c.add("10 tasks, preemptive", [&](std::uint64_t n) { preemptive.run(n); });
  c.run(run_10);
  rate(c, run_10, "virtual time, 10 tasks of 1 kHz", figure_at_least(1e6));
  rate(c, run_preemptive, "preemptive virtual time, 10 tasks of 1 kHz", {});
  print(Figure{.row = 14, .what = "virtual time, a cycle of 1000 tasks against one of 10", .goal = ratio_at_most(2)}
            .of(c, run_1000));
}
