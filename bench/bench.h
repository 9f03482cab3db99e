// SPDX-License-Identifier: Apache-2.0
// The frame of a bench row: candidates measured in turn, repetition by repetition, and judged by the ratio inside each
// repetition. A shared machine stalls for milliseconds at any time; the median of such ratios survives that, a mean or
// a maximum does not. Beside every comparison runs an A/A control: the baseline against itself.
//
//   int main(int argc, char** argv) {
//     bench::Stage stage;                                  // one CPU, real-time priority where allowed
//     bench::Comparison reads(bench::repetitions(argc, argv));
//     auto raw = reads.add("memcpy", [&](std::uint64_t n) { while (n--) { copy(); bench::keep(target); } });
//     auto ours = reads.add("register", [&](std::uint64_t n) { while (n--) { read(); bench::keep(target); } });
//     reads.run(raw);
//     bench::print(bench::Figure{.row = 1, .what = "read 80 B", .goal = bench::ratio_at_most(1.5)}.of(reads, ours));
//   }
#pragma once

#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "chimera/base/hosted/wording.h"

namespace chimera::bench {

/// Makes the compiler believe that `value` is used and may have changed.
template <class T>
inline void keep(T& value) {
  asm volatile("" : : "r"(&value) : "memory");
}

/// Nanoseconds of a clock that never jumps.
inline double now_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
}

/// The value below which the fraction `part` of the values lies; interpolated. 0 for none.
inline double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double place = part * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const auto above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

/// Pins the calling thread to a CPU (-1: the last one) with locked memory and SCHED_FIFO 50 where allowed.
/// `realtime()` says whether it was. Never two of these spinning on all CPUs at once.
class Stage {
 public:
  explicit Stage(int cpu = -1) {
    const int cpus = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(cpu < 0 ? cpus - 1 : cpu % cpus), &one);
    pinned_ = sched_setaffinity(0, sizeof one, &one) == 0;
    const sched_param priority{.sched_priority = 50};
    realtime_ = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
    mlockall(MCL_CURRENT | MCL_FUTURE);
  }
  bool pinned() const { return pinned_; }
  bool realtime() const { return realtime_; }

 private:
  bool pinned_ = false;
  bool realtime_ = false;
};

/// Runs `body` in a thread of its own on `cpu` at normal priority; joins when destroyed.
/// A row uses it for its other side, such as a writer beside the reader. `body` must return by itself or by a flag.
class Beside {
 public:
  template <class Body>
  Beside(int cpu, Body body)
      : thread_([cpu, body] {
          const sched_param none{.sched_priority = 0};
          sched_setscheduler(0, SCHED_OTHER, &none);
          cpu_set_t one;
          CPU_ZERO(&one);
          CPU_SET(static_cast<unsigned>(cpu), &one);
          sched_setaffinity(0, sizeof one, &one);
          body();
        }) {}

 private:
  std::jthread thread_;
};

/// `--repetitions N` of a row's command line.
inline int repetitions(int argc, char** argv, int otherwise = 201) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::string(argv[i]) == "--repetitions") return std::max(3, std::atoi(argv[i + 1]));
  }
  return otherwise;
}

/// Candidates measured in turn. A candidate does its work `n` times when called with n.
class Comparison {
 public:
  using Body = std::function<void(std::uint64_t n)>;
  using Prepare = std::function<void()>;
  using Clock = std::function<double()>;

  /// `clock` is another one only in the test of this class.
  explicit Comparison(int repetitions, Clock clock = now_ns)
      : repetitions_(repetitions), clock_(std::move(clock)) {}

  /// Returns the candidate's number. `prepare` is called before each of its turns and not measured.
  std::size_t add(std::string name, Body body, Prepare prepare = {}) {
    candidates_.push_back({std::move(name), std::move(body), std::move(prepare), {}});
    return candidates_.size() - 1;
  }
  /// Never more than `most` pieces of work in a turn: as many as a ring has room for. Before run().
  void limit(std::uint64_t most) { most_ = most; }
  /// Never less than `least`: as many as one round of a candidate takes. Before run().
  void at_least(std::uint64_t least) { batch_ = least; }

  /// Measures all; ratios are to `baseline`, which is measured twice per repetition (A/A). Once per comparison.
  void run(std::size_t baseline) {
    baseline_ = baseline;
    control_ = add("control", candidates_[baseline].body, candidates_[baseline].prepare);
    const std::uint64_t n = calibrate();
    for (int repetition = 0; repetition < repetitions_; ++repetition) {
      const double begin = clock_();
      for (std::size_t turn = 0; turn < candidates_.size(); ++turn) {
        // Another one begins each time, so that no candidate always runs behind the same neighbour.
        measure(candidates_[(turn + static_cast<std::size_t>(repetition)) % candidates_.size()], n);
      }
      rest((clock_() - begin) / 4);
    }
  }

  /// Median nanoseconds of one piece of work.
  double cost(std::size_t candidate) const { return median(candidates_[candidate].ns); }
  /// Median over the repetitions of (candidate / other) inside each.
  double ratio(std::size_t candidate, std::size_t other) const { return median(ratios(candidate, other)); }
  /// How far the baseline is from itself: the larger of its median distance and half its interquartile range.
  double aa_spread() const {
    const auto control = ratios(control_, baseline_);
    return std::max(std::abs(median(control) - 1), (quantile(control, 0.75) - quantile(control, 0.25)) / 2);
  }
  std::size_t baseline() const { return baseline_; }
  const std::string& name(std::size_t candidate) const { return candidates_[candidate].name; }
  std::uint64_t n() const { return static_cast<std::uint64_t>(repetitions_) * batch_; }

 private:
  struct Candidate {
    std::string name;
    Body body;
    Prepare prepare;
    std::vector<double> ns;  // per repetition, of one piece of work
  };

  /// Work that the slowest candidate does in 200 us: long against a clock read, short against a scheduler's tick.
  std::uint64_t calibrate() {
    constexpr double kBatchNs = 200e3;
    while (batch_ < most_) {
      double slowest = 0;
      for (auto& candidate : candidates_) {
        if (candidate.prepare) candidate.prepare();
        const double begin = clock_();
        candidate.body(batch_);
        slowest = std::max(slowest, clock_() - begin);
      }
      if (slowest >= kBatchNs) break;
      batch_ = std::min(2 * batch_, most_);
    }
    return batch_;
  }

  void measure(Candidate& candidate, std::uint64_t n) {
    candidate.body(std::max<std::uint64_t>(1, n / 16));  // its data back into the cache
    if (candidate.prepare) candidate.prepare();
    const double begin = clock_();
    candidate.body(n);
    candidate.ns.push_back((clock_() - begin) / static_cast<double>(n));
  }

  /// Leaves the kernel's share of the CPU: above 95 % real-time threads are throttled.
  static void rest(double ns) {
    const timespec pause{.tv_sec = 0, .tv_nsec = static_cast<long>(std::clamp(ns, 1e4, 2e8))};
    nanosleep(&pause, nullptr);
  }

  std::vector<double> ratios(std::size_t candidate, std::size_t other) const {
    std::vector<double> result;
    for (std::size_t i = 0; i < candidates_[candidate].ns.size(); ++i) {
      result.push_back(candidates_[candidate].ns[i] / candidates_[other].ns[i]);
    }
    return result;
  }

  int repetitions_;
  Clock clock_;
  std::uint64_t batch_ = 1, most_ = 1'000'000'000;
  std::size_t baseline_ = 0;
  std::size_t control_ = 0;
  std::vector<Candidate> candidates_;
};

/// Promise of a row: a bound on the ratio or on the figure itself, or nothing (reported only).
struct Goal {
  enum Of { kNothing, kRatio, kFigure } of = kNothing;
  bool at_most = true;
  double bound = 0;
};
inline Goal ratio_at_most(double bound) { return {Goal::kRatio, true, bound}; }
inline Goal ratio_at_least(double bound) { return {Goal::kRatio, false, bound}; }
inline Goal figure_at_most(double bound) { return {Goal::kFigure, true, bound}; }
inline Goal figure_at_least(double bound) { return {Goal::kFigure, false, bound}; }

/// One figure of a row, as `./dev bench` shows it. Fields that are not filled are shown as "-".
struct Figure {
  int row = 0;
  std::string what = {};
  std::string unit = "ns";
  double figure = NAN;
  double baseline = NAN;  // figure of the alternative that a user has, in the unit of `figure`, from this run
  std::string baseline_name = {};
  double limit = NAN;     // physical lower bound, in the unit of `figure`, from this run
  double ratio = NAN;     // figure / baseline, the median of the ratios where there are repetitions
  Goal goal = {};
  double aa_spread = NAN;
  std::uint64_t n = 0;

  /// This figure filled in from a comparison that has run.
  Figure of(const Comparison& comparison, std::size_t candidate) const {
    Figure filled = *this;
    filled.figure = comparison.cost(candidate);
    filled.baseline = comparison.cost(comparison.baseline());
    filled.baseline_name = comparison.name(comparison.baseline());
    filled.ratio = comparison.ratio(candidate, comparison.baseline());
    filled.aa_spread = comparison.aa_spread();
    filled.n = comparison.n();
    return filled;
  }

  bool met() const {
    const double value = goal.of == Goal::kRatio ? ratio : figure;
    if (goal.of == Goal::kNothing) return true;
    return goal.at_most ? value <= goal.bound : value >= goal.bound;
  }

  /// One JSON object, one line.
  std::string json() const {
    return "{\"row\": " + std::to_string(row) + ", \"what\": " + backslashed(what) + ", \"figure\": " + number(figure) +
           ", \"unit\": " + backslashed(unit) + ", \"baseline\": " + number(baseline) +
           ", \"baseline_name\": " + backslashed(baseline_name) + ", \"limit\": " + number(limit) +
           ", \"ratio\": " + number(ratio) + ", \"goal\": " + backslashed(goal_text()) +
           ", \"met\": " + (goal.of == Goal::kNothing ? "null" : met() ? "true" : "false") +
           ", \"aa_spread\": " + number(aa_spread) + ", \"n\": " + std::to_string(n) + "}";
  }

 private:
  std::string goal_text() const {
    if (goal.of == Goal::kNothing) return "";
    return std::string(goal.of == Goal::kRatio ? "ratio" : "figure") + (goal.at_most ? " <= " : " >= ") +
           number(goal.bound);
  }
  static std::string number(double value) {
    if (!std::isfinite(value)) return "null";
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", value);
    return digits;
  }
};

inline void print(const Figure& figure) {
  std::printf("%s\n", figure.json().c_str());
  std::fflush(stdout);
}

}  // namespace chimera::bench
