// SPDX-License-Identifier: Apache-2.0
// Three ways to run n periodic tasks on one CPU by preemptive scheduling, for the rows that compare them:
// ours (labels), a thread for each task at a fixed priority, and a dispatcher thread that wakes the threads of tasks.
#pragma once

#include <sys/resource.h>

#include <atomic>
#include <deque>
#include <memory>
#include <thread>
#include <vector>

#include "bench/bench.h"
#include "bench/tasks.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/realtime.h"
#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera::bench {

inline constexpr int kCeiling = 49;
inline constexpr Nanoseconds kLeadIn = milliseconds(20);  // before anything is measured

/// The last one.
inline int bench_cpu() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())) - 1; }

/// n tasks of one period, released one after the other over the period or all at one instant.
struct Load {
  std::uint32_t n = 10;
  Nanoseconds period = milliseconds(1);
  bool staggered = true;

  Nanoseconds step() const { return staggered ? Nanoseconds{period.count / n} : Nanoseconds{}; }
};

/// Cost of a run, and how late its jobs began.
struct Cost {
  std::uint64_t jobs = 0;
  double cpu_ns = 0;       // of the process, a job
  double switches = 0;     // a job
  double level_changes = 0;
  std::vector<double> late_ns;
};

/// Measures a window: processor time of the process and switches of its threads.
class Window {
 public:
  Window() { read(cpu_, switches_); }
  void end(Cost& cost) const {
    double cpu = 0, switches = 0;
    read(cpu, switches);
    cost.cpu_ns = (cpu - cpu_) / static_cast<double>(cost.jobs);
    cost.switches = (switches - switches_) / static_cast<double>(cost.jobs);
  }

 private:
  static void read(double& cpu, double& switches) {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    cpu = static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    switches = static_cast<double>(usage.ru_nvcsw + usage.ru_nivcsw);
  }
  double cpu_ = 0, switches_ = 0;
};

/// Starts the preemptive executor for `axes` and lets `use` run it, in a thread at the ceiling of the last CPU.
template <class Use>
void with_executor(Axes& axes, Policy policy, Use use) {
  RunOptions options;
  options.policy = policy;
  ProcessorPlace place;
  place.cpu = bench_cpu();
  place.ceiling = kCeiling;
  place.base = kCeiling - 19;
  PreemptiveExecutor executor(axes.set(), options, place);
  std::thread edges([&] {
    (void)enter_realtime({kCeiling, place.cpu, false});
    if (!executor.start()) std::exit(1);
    use(executor);
  });
  edges.join();
}

/// Ours: the preemptive executor under `policy`. `budget` zero: budgets are not stated.
inline Cost run_ours(const Load& load, Policy policy, Nanoseconds time, Nanoseconds budget = {},
                     const chimera_component& component = axis_component()) {
  AxesForm form;
  form.preemptive = true;
  form.offset_step = load.step();
  form.budget = budget;
  form.component = &component;
  Axes axes(load.n, [&](std::uint32_t) { return load.period; }, form);
  Cost cost;
  with_executor(axes, policy, [&](PreemptiveExecutor& executor) {
    (void)executor.run(kLeadIn);
    const ProcessorCounts before = executor.counts();
    const Window window;
    (void)executor.run(kLeadIn + time);
    const ProcessorCounts after = executor.counts();
    cost.jobs = after.jobs - before.jobs;
    cost.level_changes =
        static_cast<double>(after.level_changes - before.level_changes) / static_cast<double>(cost.jobs);
    window.end(cost);
  });
  return cost;
}

/// Cost of the threads that count their jobs in `jobs`, from kLeadIn after `origin` to `end`.
inline Cost measured(const std::atomic<std::uint64_t>& jobs, Nanoseconds origin, Nanoseconds end) {
  LinuxClock clock;
  (void)clock.wait_until(origin + kLeadIn);
  Cost cost;
  const std::uint64_t before = jobs;
  const Window window;
  (void)clock.wait_until(end);
  cost.jobs = jobs - before;
  window.end(cost);
  return cost;
}

/// The work of one job without any framework.
class RawAxis {
 public:
  void operator()() {
    std::array<double, kAxes> in = values_;
    for (double& value : in) value = 0.5 * value + 1.0;
    values_ = in;
    keep(values_);
  }

 private:
  std::array<double, kAxes> values_{};
};

/// The priority of task i where priorities are fixed.
inline int fixed_priority(std::uint32_t i) { return kCeiling - 1 - static_cast<int>(i % 18); }

/// A thread for each task that sleeps to absolute instants and runs its job at a fixed priority. `lowered`: it sleeps
/// at the ceiling and takes its priority for the job only, the least that any order by urgency costs.
inline Cost run_threads(const Load& load, Nanoseconds time, bool lowered, bool keep_late) {
  LinuxClock clock;
  const Nanoseconds origin = clock.now() + kLeadIn, end = origin + kLeadIn + time;
  std::atomic<std::uint64_t> jobs{0};
  std::vector<std::vector<double>> late(load.n);
  std::vector<std::thread> threads;
  for (std::uint32_t i = 0; i < load.n; ++i)
    threads.emplace_back([&, i] {
      late[i].reserve(keep_late ? static_cast<std::size_t>((end - origin) / load.period) + 1 : 0);
      (void)enter_realtime({lowered ? kCeiling : fixed_priority(i), bench_cpu(), false});
      RawAxis axis;
      for (Nanoseconds next = origin + load.step() * i; next < end; next += load.period) {
        (void)clock.wait_until(next);
        if (lowered) set_level(0, fixed_priority(i));
        if (keep_late) late[i].push_back(static_cast<double>((clock.now() - next).count));
        axis();
        if (lowered) set_level(0, kCeiling);
        jobs.fetch_add(1, std::memory_order_relaxed);
      }
    });
  Cost cost = measured(jobs, origin, end);
  for (std::thread& thread : threads) thread.join();
  for (const auto& one : late) cost.late_ns.insert(cost.late_ns.end(), one.begin(), one.end());
  return cost;
}

inline Cost run_fixed(const Load& load, Nanoseconds time, bool keep_late = false) {
  return run_threads(load, time, false, keep_late);
}
inline Cost run_lowered(const Load& load, Nanoseconds time) { return run_threads(load, time, true, false); }

/// A dispatcher thread above the others sleeps to each release and wakes the thread of the task, which reports its end.
class Dispatched {
 public:
  explicit Dispatched(const Load& load) : load_(load), bells_(load.n) {}

  /// The thread of task i, until the dispatcher ends.
  void follow(std::uint32_t i) {
    (void)enter_realtime({fixed_priority(i), bench_cpu(), false});
    RawAxis axis;
    for (std::uint32_t heard = 0;; ++heard) {
      while (Doorbell(bells_[i]).read() == heard) (void)Doorbell(bells_[i]).wait_until(heard, kNever);
      if (over_) return;
      axis();
      jobs_.fetch_add(1, std::memory_order_relaxed);
      Doorbell(done_).ring();
    }
  }
  void dispatch(Nanoseconds origin, Nanoseconds end) {
    (void)enter_realtime({kCeiling, bench_cpu(), false});
    std::vector<Nanoseconds> next(load_.n);
    for (std::uint32_t i = 0; i < load_.n; ++i) next[i] = origin + load_.step() * i;
    for (;;) {
      const std::uint32_t seen = Doorbell(done_).read();
      const Nanoseconds now = LinuxClock().now();
      if (now >= end) break;
      (void)Doorbell(done_).wait_until(seen, std::min(release(next, now), end));
    }
    over_ = true;
    for (auto& bell : bells_) Doorbell(bell).ring();
  }
  const std::atomic<std::uint64_t>& jobs() const { return jobs_; }

 private:
  // Wakes those whose release has come; answers with the next release.
  Nanoseconds release(std::vector<Nanoseconds>& next, Nanoseconds now) {
    Nanoseconds soonest = kNever;
    for (std::uint32_t i = 0; i < load_.n; ++i) {
      if (next[i] <= now) {
        Doorbell(bells_[i]).ring();
        next[i] += load_.period;
      }
      soonest = std::min(soonest, next[i]);
    }
    return soonest;
  }

  const Load load_;
  std::deque<std::atomic<std::uint32_t>> bells_;
  std::atomic<std::uint32_t> done_{0};
  std::atomic<std::uint64_t> jobs_{0};
  std::atomic<bool> over_{false};
};

inline Cost run_dispatched(const Load& load, Nanoseconds time) {
  const Nanoseconds origin = LinuxClock().now() + kLeadIn, end = origin + kLeadIn + time;
  Dispatched tasks(load);
  std::vector<std::thread> threads;
  for (std::uint32_t i = 0; i < load.n; ++i) threads.emplace_back([&tasks, i] { tasks.follow(i); });
  threads.emplace_back([&] { tasks.dispatch(origin, end); });
  const Cost cost = measured(tasks.jobs(), origin, end);
  for (std::thread& thread : threads) thread.join();
  return cost;
}

}  // namespace chimera::bench
