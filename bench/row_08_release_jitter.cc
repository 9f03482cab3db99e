// SPDX-License-Identifier: Apache-2.0
// Row 8: how late a periodic job begins in the preemptive executor, against a raw loop of absolute sleeps in the same
// run, in turn; cyclictest beside it where it is installed (rt-tests). Judged: ratios of p50 and p99, never a maximum.
#include <cstring>

#include "bench/preemptive.h"

namespace chimera::bench {
namespace {

constexpr Nanoseconds kTime = seconds(2);

std::vector<double>* late_jobs = nullptr;  // of the one task that runs

std::int32_t timed_cycle(void* memory, const chimera_call* call) {
  const Nanoseconds late = LinuxClock().now() - Nanoseconds{call->now_ns};
  if (late_jobs->size() < late_jobs->capacity()) late_jobs->push_back(static_cast<double>(late.count));
  return axis_cycle(memory, call);
}

std::vector<double> ours(const Load& load) {
  static const chimera_component component = [] {
    chimera_component c = axis_component();
    c.methods[CHIMERA_CYCLE] = timed_cycle;
    return c;
  }();
  std::vector<double> late;
  late.reserve(static_cast<std::size_t>(kTime / load.period) + 100);
  late_jobs = &late;
  (void)run_ours(load, Policy::kRm, kTime, {}, component);
  return late;
}

// p50 and p99 in nanoseconds of `cyclictest`'s histogram; empty without it.
std::vector<double> cyclictest(const Load& load) {
  const std::string command = "cyclictest -m -q -p " + std::to_string(kCeiling) + " -t 1 -a " +
                              std::to_string(bench_cpu()) + " -i " + std::to_string(load.period.count / 1000) +
                              " -l " + std::to_string(kTime / load.period) + " -h 2000 2>/dev/null";
  std::FILE* output = ::popen(command.c_str(), "r");
  if (output == nullptr) return {};
  std::vector<double> late;
  char line[256];
  while (std::fgets(line, sizeof line, output) != nullptr) {
    int us = 0;
    unsigned long count = 0;
    if (std::sscanf(line, "%d %lu", &us, &count) == 2 && line[0] != '#') late.insert(late.end(), count, us * 1000.0);
  }
  ::pclose(output);
  return late;
}

void compare(Nanoseconds period, int repetitions) {
  const Load load{1, period, true};
  const std::string rate = std::to_string(1'000'000'000 / period.count) + " Hz";
  std::vector<double> a50, a99, b50, b99, c50, c99, r50, r99, control50, control99;
  for (int i = 0; i < repetitions; ++i) {
    const auto raw = run_fixed(load, kTime, true).late_ns;
    const auto mine = ours(load);
    const auto again = run_fixed(load, kTime, true).late_ns;
    const auto test = cyclictest(load);
    a50.push_back(quantile(mine, 0.5)), a99.push_back(quantile(mine, 0.99));
    b50.push_back(quantile(raw, 0.5)), b99.push_back(quantile(raw, 0.99));
    r50.push_back(a50.back() / b50.back()), r99.push_back(a99.back() / b99.back());
    control50.push_back(quantile(again, 0.5) / b50.back()), control99.push_back(quantile(again, 0.99) / b99.back());
    if (!test.empty()) c50.push_back(quantile(test, 0.5)), c99.push_back(quantile(test, 0.99));
  }
  const auto spread = [](const std::vector<double>& control) {
    return std::max(std::abs(median(control) - 1), (quantile(control, 0.75) - quantile(control, 0.25)) / 2);
  };
  const auto figure = [&](const char* what, const auto& mine, const auto& raw, const auto& ratio, const auto& control,
                          const auto& test, double most) {
    Figure f{.row = 8, .what = std::string("start delay, ") + what + ", " + rate, .unit = "ns"};
    f.figure = median(mine), f.baseline = median(raw), f.baseline_name = "raw loop", f.ratio = median(ratio);
    f.aa_spread = spread(control), f.goal = ratio_at_most(std::max(most, 1 + f.aa_spread));
    f.n = mine.size();
    print(f);
    if (test.empty()) return;
    Figure c{.row = 8, .what = std::string("start delay, ") + what + ", " + rate, .unit = "ns"};
    c.figure = median(mine), c.baseline = median(test), c.baseline_name = "cyclictest", c.n = test.size();
    c.ratio = c.figure / c.baseline;
    print(c);
  };
  figure("p50", a50, b50, r50, control50, c50, 1.15);
  figure("p99", a99, b99, r99, control99, c99, 1.1);
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera;
  const int n = bench::repetitions(argc, argv, 10);
  bench::compare(milliseconds(1), n);
  bench::compare(microseconds(200), n);
}
