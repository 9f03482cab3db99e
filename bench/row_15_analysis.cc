// SPDX-License-Identifier: Apache-2.0
// Row 15: the analysis of 1,000 tasks of one CPU at a load of 0.9, under each policy, preemptive and in an executive:
// periods from 1 ms to 1 s, half of the deadlines shorter.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "chimera/schedule/analysis.h"

namespace {

using namespace chimera;

constexpr std::size_t kTasks = 1000;

std::vector<Work> thousand() {
  std::mt19937 random(1);
  const auto share = [&random] { return std::uniform_real_distribution<double>(0, 1)(random); };
  std::vector<Work> works;
  for (std::size_t i = 0; i < kTasks; ++i) {
    Work w;
    w.period = microseconds(std::llround(1000 * std::pow(1000.0, share())));
    w.time = Nanoseconds{std::llround(0.9 / kTasks * static_cast<double>(w.period.count))};
    w.deadline = share() < 0.5 ? w.period : Nanoseconds{w.period.count - w.period.count / 10};
    w.criticality = static_cast<std::uint32_t>(random() % 3);
    works.push_back(w);
  }
  return works;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Work> works = thousand();
  std::vector<WorkVerdict> verdicts(kTasks);
  std::vector<RankedWork> room(kTasks);
  const int repetitions = bench::repetitions(argc, argv, 11);
  struct { Policy policy; const char* name; } constexpr kPolicies[] = {
      {Policy::kRm, "rm"}, {Policy::kEdf, "edf"}, {Policy::kMuf, "muf"}, {Policy::kMufLaxity, "muf-laxity"}};
  for (const auto& [policy, name] : kPolicies)
    for (const Dispatch dispatch : {Dispatch::kPreemptive, Dispatch::kExecutive}) {
      const std::vector<ProcessorUse> uses = {{.cpu = 0, .criticality = 2, .policy = policy, .dispatch = dispatch,
                                               .quantum = microseconds(500)}};
      std::vector<double> seconds;
      CpuVerdict verdict;
      for (int i = 0; i < repetitions; ++i) {
        const double start = bench::now_ns();
        verdict = analyse(works, uses, 0, verdicts, room);
        bench::keep(verdict);
        seconds.push_back((bench::now_ns() - start) * 1e-9);
      }
      const std::string what = std::string("analysis of 1,000 tasks, ") + name +
                               (dispatch == Dispatch::kExecutive ? ", executive" : ", preemptive");
      bench::print({.row = 15, .what = what.c_str(), .unit = "s", .figure = bench::median(seconds),
                    .goal = bench::figure_at_most(1), .n = static_cast<std::uint64_t>(repetitions)});
      if (std::any_of(verdicts.begin(), verdicts.end(),
                      [](const WorkVerdict& v) { return v.guarantee == Guarantee::kTooLong; })) {
        std::fprintf(stderr, "%s: given up\n", what.c_str());
        return 1;
      }
    }
  return 0;
}
