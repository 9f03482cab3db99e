// SPDX-License-Identifier: Apache-2.0
// Row 10: how much of a processor random sets of ten tasks of 1 to 20 ms may use before one misses a deadline, in
// preemptive virtual time (1,000 sets); whether rate monotonic breaks down where the exact analysis says (Joseph &
// Pandya 1986); whether the critical set of MUF misses anything at 150 % load; and 20 sets in real time at 0.90.
#include <cmath>
#include <random>

#include "bench/preemptive.h"
#include "chimera/runtime/virtual/virtual_executor.h"

namespace chimera::bench {
namespace {

constexpr std::uint32_t kTasks = 10;
constexpr Nanoseconds kVirtualTime = milliseconds(200);

struct Set {
  std::vector<Nanoseconds> periods;
  std::vector<double> shares;  // of the processor, 1 in all

  std::vector<Nanoseconds> budgets(double utilisation) const {
    std::vector<Nanoseconds> budgets;
    for (std::uint32_t i = 0; i < kTasks; ++i) {
      const double ns = utilisation * shares[i] * static_cast<double>(periods[i].count);
      budgets.push_back({std::max<std::int64_t>(1, static_cast<std::int64_t>(ns))});
    }
    return budgets;
  }
};

Set random_set(std::mt19937& random) {
  Set set;
  double sum = 0;
  for (std::uint32_t i = 0; i < kTasks; ++i) {
    const double part = std::exp(std::log(20.0) * static_cast<double>(random() % 10'001) / 10'000);  // log-uniform
    set.periods.push_back(microseconds(static_cast<std::int64_t>(part * 1000)));
    set.shares.push_back(0.05 + static_cast<double>(random() % 1000) / 1000);
    sum += set.shares.back();
  }
  for (double& share : set.shares) share /= sum;
  return set;
}

// Deadlines missed by the first `counted` tasks in virtual time.
std::uint64_t missed(const Set& set, Policy policy, double utilisation, std::uint32_t critical = 0,
                     std::uint32_t counted = kTasks) {
  AxesForm form;
  form.budgets = set.budgets(utilisation);
  form.critical = critical;
  Axes axes(kTasks, [&](std::uint32_t i) { return set.periods[i]; }, form);
  RunOptions options;
  options.policy = policy;
  VirtualOptions how;
  how.preemptive = true;
  VirtualExecutor executor(axes.set(), options, how);
  if (!executor.start()) std::exit(1);
  executor.run(kVirtualTime);
  std::uint64_t n = 0;
  for (std::uint32_t i = 0; i < counted; ++i) n += axes.set().tasks()[i].profile.missed;
  return n;
}

// The exact test for fixed priorities and synchronous release: does every first job end within its period?
bool fits_exactly(const Set& set, double utilisation) {
  const auto budgets = set.budgets(utilisation);
  for (std::uint32_t i = 0; i < kTasks; ++i) {
    Nanoseconds response = budgets[i], before;
    while (response != before && response <= set.periods[i]) {
      before = response;
      response = budgets[i];
      for (std::uint32_t j = 0; j < kTasks; ++j) {
        const bool first = set.periods[j] < set.periods[i] || (set.periods[j] == set.periods[i] && j < i);
        if (first) response += budgets[j] * ((before.count + set.periods[j].count - 1) / set.periods[j].count);
      }
    }
    if (response > set.periods[i]) return false;
  }
  return true;
}

// Bisects for the largest utilisation, in steps of 0.01, at which `fits` holds.
template <class Fits>
double breakdown(Fits fits) {
  int low = 0, high = 100;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (fits(middle / 100.0)) low = middle;
    else high = middle - 1;
  }
  return low / 100.0;
}

void show(std::string what, double figure, Goal goal, std::uint64_t n, std::string unit = "of a CPU") {
  Figure f{.row = 10, .what = std::move(what), .unit = std::move(unit), .goal = goal};
  f.figure = figure;
  f.n = n;
  print(f);
}

void in_virtual_time(std::uint64_t sets) {
  std::mt19937 random(1);
  double edf = 0, muf = 0, rm = 0, exact = 0;
  std::uint64_t critical_missed = 0, differ = 0;
  for (std::uint64_t i = 0; i < sets; ++i) {
    const Set set = random_set(random);
    edf += breakdown([&](double u) { return missed(set, Policy::kEdf, u) == 0; });
    muf += breakdown([&](double u) { return missed(set, Policy::kMuf, u) == 0; });
    const double simulated = breakdown([&](double u) { return missed(set, Policy::kRm, u) == 0; });
    const double analysed = breakdown([&](double u) { return fits_exactly(set, u); });
    rm += simulated;
    exact += analysed;
    differ += simulated != analysed;
    double critical_share = 0;
    for (std::uint32_t t = 0; t < kTasks / 2; ++t) critical_share += set.shares[t];
    if (critical_share <= 0.62) critical_missed += missed(set, Policy::kMuf, 1.5, kTasks / 2, kTasks / 2);
  }
  const auto n = static_cast<double>(sets);
  show("breakdown utilisation under edf, virtual time, mean", edf / n, figure_at_least(0.97), sets);
  show("breakdown utilisation under muf (all of one criticality)", muf / n, figure_at_least(0.97), sets);
  Figure f{.row = 10, .what = "breakdown utilisation under rm, virtual time, mean", .unit = "of a CPU"};
  f.figure = rm / n, f.baseline = exact / n, f.baseline_name = "exact analysis", f.ratio = rm / exact;
  f.n = sets;
  print(f);
  show("sets whose breakdown under rm is not where the analysis says", static_cast<double>(differ), figure_at_most(0),
       sets, "sets");
  show("deadlines missed by the critical set under muf at 150 % load", static_cast<double>(critical_missed),
       figure_at_most(0), sets, "misses");
}

std::int64_t spends[kTasks];

std::int32_t spending_cycle(void*, const chimera_call* call) {
  // The period identifies the task: no two are equal.
  for (std::uint32_t i = 0; i < kTasks; ++i)
    if (call->deadline_ns - call->now_ns == spends[i] >> 32) call->host->spend(call->context, spends[i] & 0xffffffff);
  return CHIMERA_OK;
}

void in_real_time(int sets, Policy policy, const char* name) {
  static const chimera_component component = [] {
    chimera_component c = axis_component();
    c.methods[CHIMERA_CYCLE] = spending_cycle;
    return c;
  }();
  std::mt19937 random(2);
  int clean = 0;
  for (int i = 0; i < sets; ++i) {
    Set set = random_set(random);
    for (std::uint32_t t = 0; t < kTasks; ++t) set.periods[t] = Nanoseconds{set.periods[t].count / 1000 * 1000 + t};
    AxesForm form;
    form.preemptive = true;
    form.component = &component;
    form.budgets = set.budgets(1.2);
    const auto work = set.budgets(0.9);
    for (std::uint32_t t = 0; t < kTasks; ++t) spends[t] = set.periods[t].count << 32 | work[t].count;
    Axes axes(kTasks, [&](std::uint32_t t) { return set.periods[t]; }, form);
    with_executor(axes, policy, [](PreemptiveExecutor& executor) { (void)executor.run(milliseconds(500)); });
    std::uint64_t all = 0;
    for (const Task& task : axes.set().tasks()) all += task.profile.missed;
    clean += all == 0;
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(300));
  }
  show(std::string("sets that miss nothing in real time at 0.90 under ") + name, clean, {},
       static_cast<std::uint64_t>(sets), "sets");
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera;
  using namespace chimera::bench;
  in_virtual_time(static_cast<std::uint64_t>(repetitions(argc, argv, 1000)));
  in_real_time(20, Policy::kEdf, "edf");
  in_real_time(20, Policy::kMuf, "muf");
}
