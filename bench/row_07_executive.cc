// SPDX-License-Identifier: Apache-2.0
// Row 7: what the executive adds to a component's own code and its clock reads, per job, profiling on.
// The clock is the real one; waits are skipped by setting it forward, so that only work is measured.
#include <string_view>

#include "bench/bench.h"
#include "bench/tasks.h"
#include "chimera/runtime/executive/counter_clock.h"
#include "chimera/runtime/executive/executive.h"

namespace chimera::bench {
namespace {

class SkippingClock final : public Clock {
 public:
  Nanoseconds now() noexcept override { return last_ = clock_.now() + skipped_; }
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    if (instant > last_) skipped_ += instant - last_;
    return WaitEnd::kReached;
  }
  // Between two runs of an executive its time stands still.
  void pause() noexcept { paused_ = now(); }
  void resume() noexcept { skipped_ -= now() - paused_; }

 private:
  CounterClock clock_;
  Nanoseconds skipped_;
  Nanoseconds last_;
  Nanoseconds paused_;
};

// One executive over n tasks, and beside it the same bodies called in a plain loop with one clock read each.
class Candidate {
 public:
  template <class Period>
  Candidate(std::uint32_t n, Period period, Tap* tap = nullptr)
      : axes_(n, period), job_clock_(clock_), executive_(axes_.set(), clock_, job_clock_, options(tap)), periods_(n) {
    if (!executive_.start()) std::exit(1);
    clock_.pause();
  }
  // Runs about `jobs` jobs of tasks at 1 kHz, whatever the clock shows after a stall of the machine.
  void run(std::uint64_t jobs) {
    clock_.resume();
    const Nanoseconds begun = milliseconds((clock_.now() - executive_.origin()) / milliseconds(1));
    executive_.run(begun + milliseconds(periods_.of(jobs)) + microseconds(500));
    clock_.pause();
  }
  // The bodies alone, with the clock reads that the executive needs: one at each wake, one at the end of each job.
  void run_bare(std::uint64_t jobs, std::uint64_t jobs_per_wake) {
    std::uint64_t since_wake = 0;
    for (std::uint64_t i = 0; i < jobs;) {
      for (const Task& task : axes_.set().tasks()) {
        if (i++ == jobs) return;
        if (since_wake++ % jobs_per_wake == 0) read_clock();
        task.component->methods[CHIMERA_CYCLE](task.instance, &task.call);
        read_clock();
      }
    }
  }
  std::uint64_t cycles() const {
    std::uint64_t sum = 0;
    for (const Task& task : const_cast<Axes&>(axes_).set().tasks()) sum += task.profile.cycles;
    return sum;
  }
  std::uint64_t dropped() const {
    std::uint64_t sum = 0;
    for (const Task& task : const_cast<Axes&>(axes_).set().tasks()) sum += task.profile.dropped;
    return sum;
  }

 private:
  static RunOptions options(Tap* tap) {
    RunOptions o;
    o.tap = tap;
    return o;
  }
  void read_clock() {
    Nanoseconds now = static_cast<Clock&>(clock_).now();
    keep(now);
  }

  Axes axes_;
  SkippingClock clock_;
  ComputingClock job_clock_;
  Executive executive_;
  Periods periods_;
};

Nanoseconds at_1_khz(std::uint32_t) { return milliseconds(1); }

void beyond(const Comparison& c, std::size_t executive, std::size_t bare, const char* what, Goal goal) {
  Figure figure{.row = 7, .what = what, .goal = goal};
  figure.figure = c.cost(executive) - c.cost(bare);
  figure.baseline = c.cost(bare);
  figure.baseline_name = "the bodies in a loop with the same clock reads";
  figure.ratio = c.cost(executive) / c.cost(bare);
  figure.aa_spread = c.aa_spread();
  figure.n = c.n();
  print(figure);
}

// What a task of 100 float64 outputs pays for each publication that goes to the tap.
void print_tapped_row(int repetitions) {
  constexpr std::uint32_t kValues = 100;
  struct {
    chimera_slot header{};
    double values[kValues] = {};
  } slot;
  const auto ring = std::make_unique<TapRing>();
  Tap tap(*ring);
  std::uint32_t row = 0;
  std::array<TapRecord, kValues + 1> records{};
  std::size_t at = 0;
  Comparison c(repetitions);
  const auto copied = c.add("copied", [&](std::uint64_t n) {
    while (n--) {
      std::memcpy(static_cast<void*>(&ring->records[at]), records.data(), sizeof records);
      at = (at + records.size()) % (kTapRecords - records.size());
      keep(*ring);
    }
  });
  const auto tapped = c.add("tapped", [&](std::uint64_t n) {
    while (n--) tap.append_row(slot.header, sizeof slot.values, TaskId{0u}, 0, row++);
  });
  c.run(copied);
  Figure figure{.row = 7, .what = "the tap of 100 float64 outputs, per cycle", .goal = {}};
  figure.figure = c.cost(tapped);
  figure.baseline = c.cost(copied);
  figure.baseline_name = "memcpy of as many records";
  figure.ratio = c.ratio(tapped, copied);
  figure.aa_spread = c.aa_spread();
  figure.n = c.n();
  print(figure);
}

// For row_07_linuxcnc_peer.py: 201 tasks at 1 kHz in real time for a second, waits and cold caches included.
// The end of one job is the start of the next, so the execution times of one wake add up to all of its work.
int run_in_real_time() {
  constexpr std::uint32_t kTasks = 201;
  Axes axes(kTasks, at_1_khz);
  CounterClock clock;
  ComputingClock job_clock(clock);
  Executive executive(axes.set(), clock, job_clock, {});
  if (!executive.start()) return 1;
  executive.run(seconds(1));
  std::int64_t used = 0;
  std::uint64_t jobs = 0;
  for (const Task& task : axes.set().tasks()) {
    used += task.profile.execution[CHIMERA_CYCLE].sum.count;
    jobs += task.profile.execution[CHIMERA_CYCLE].count;
  }
  if (jobs < 100 * kTasks) return 1;
  std::printf("%.3f ns per job; %s\n", static_cast<double>(used) / static_cast<double>(jobs), clock.describe());
  return 0;
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera;
  using namespace chimera::bench;
  Stage stage;
  if (argc > 1 && std::string_view(argv[1]) == "--real-time") return run_in_real_time();
  Candidate ten(10, at_1_khz), thousand(1000, at_1_khz);
  // Ten rates side by side: every pop chooses between classes.
  Candidate mixed(10, [](std::uint32_t i) { return milliseconds(1) + microseconds(7) * i; });
  const auto ring = std::make_unique<TapRing>();
  Tap tap(*ring);
  TapReader reader(*ring);
  Candidate tapped(10, at_1_khz, &tap);
  Comparison c(repetitions(argc, argv));
  c.at_least(10'000);  // ten rounds of a thousand
  const auto bare_10 = c.add("bodies of 10", [&](std::uint64_t n) { ten.run_bare(n, 10); });
  const auto bare_1000 = c.add("bodies of 1000", [&](std::uint64_t n) { thousand.run_bare(n, 1000); });
  const auto bare_mixed = c.add("bodies of 10 rates", [&](std::uint64_t n) { mixed.run_bare(n, 1); });
  const auto run_10 = c.add("executive of 10", [&](std::uint64_t n) { ten.run(n); });
  const auto run_1000 = c.add("executive of 1000", [&](std::uint64_t n) { thousand.run(n); });
  const auto run_mixed = c.add("executive of 10 rates", [&](std::uint64_t n) { mixed.run(n); });
  std::array<TapRecord, 4096> drain;
  const auto run_tapped = c.add("executive of 10, tapped", [&](std::uint64_t n) {
    tapped.run(n);
    reader.read(drain);
  });
  c.run(bare_10);
  if (ten.cycles() == 0 || thousand.dropped() > thousand.cycles() / 100) {
    std::fprintf(stderr, "the executive did not run what was measured\n");
    return 1;
  }
  beyond(c, run_10, bare_10, "executive, per job beyond its body and its clock read, 10 tasks", figure_at_most(25));
  beyond(c, run_1000, bare_1000, "the same, 1000 tasks", figure_at_most(35));
  beyond(c, run_mixed, bare_mixed, "the same, 10 tasks of 10 rates, a wake for each job", {});
  beyond(c, run_tapped, bare_10, "the same, 10 tasks with the tap on", {});
  Figure growth{.row = 7, .what = "executive, whole job, 1000 tasks against 10", .goal = ratio_at_most(2)};
  growth.figure = c.cost(run_1000);
  growth.baseline = c.cost(run_10);
  growth.baseline_name = "10 tasks";
  growth.ratio = c.ratio(run_1000, run_10);
  growth.aa_spread = c.aa_spread();
  growth.n = c.n();
  print(growth);
  print_tapped_row(repetitions(argc, argv));
}
