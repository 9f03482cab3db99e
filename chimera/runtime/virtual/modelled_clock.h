// SPDX-License-Identifier: Apache-2.0
// The clock of virtual time, and the modelled execution time of a job.
#pragma once

#include <cstdint>

#include "chimera/runtime/job/job_clock.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// A number that looks random and depends on (seed, task, release) alone, so that neither the order of jobs nor the
/// machine changes it. Context: any; wait-free.
constexpr std::uint64_t mixed(std::uint64_t seed, std::uint64_t task, std::uint64_t release) noexcept {
  std::uint64_t x = seed;
  for (const std::uint64_t word : {task, release, std::uint64_t{0}}) {  // splitmix64's finish, once per word
    x += word + 0x9E37'79B9'7F4A'7C15u;
    x = (x ^ (x >> 30)) * 0xBF58'476D'1CE4'E5B9u;
    x = (x ^ (x >> 27)) * 0x94D0'49BB'1331'11EBu;
    x ^= x >> 31;
  }
  return x;
}

/// A time in [low, high] chosen by `random`. Context: any; wait-free.
constexpr Nanoseconds between(Nanoseconds low, Nanoseconds high, std::uint64_t random) noexcept {
  if (high <= low) return high;
  const auto width = static_cast<std::uint64_t>((high - low).count) + 1;
  __extension__ using Wide = unsigned __int128;
  return low + Nanoseconds{static_cast<std::int64_t>((static_cast<Wide>(random) * width) >> 64)};
}

/// Virtual time as methods see it: it advances only by the time they spend.
class ModelledClock final : public JobClock {
 public:
  Nanoseconds now() noexcept override { return now_ + spent_; }
  void spend(Nanoseconds time) noexcept override {
    if (!stands_still_) spent_ += time;
  }
  /// From now on methods spend no time. Context: setup.
  void stand_still() noexcept { stands_still_ = true; }

  /// Context: cycle; the executor only.
  void set(Nanoseconds now) noexcept {
    now_ = now;
    spent_ = Nanoseconds{};
  }
  Nanoseconds spent() const noexcept { return spent_; }

 private:
  Nanoseconds now_, spent_;
  bool stands_still_ = false;
};

/// Execution times of jobs that differ from their budgets. Plain value.
struct JobTimes {
  JobTimes(std::uint64_t drawn_with) noexcept : seed(drawn_with) {}  // NOLINT: a seed stands for its times
  static JobTimes none() noexcept {
    JobTimes times(0);
    times.are_zero = true;
    return times;
  }

  std::uint64_t seed;     ///< they are drawn from [min, budget]
  bool are_zero = false;  ///< they are 0, whatever the methods spend
};

/// Execution time of a job whose body has run. It is the time that the body spent, if any. Otherwise `times`
/// (null: none) give it; without them it is the budget, or 0. A poll that found no event costs only what it spent.
/// Context: any; wait-free.
inline Nanoseconds modelled_time(const TaskSpec& spec, TaskId task, Nanoseconds release, Nanoseconds spent,
                                 bool had_event, const JobTimes* times) noexcept {
  if (spent > Nanoseconds{} || !had_event) return spent;
  if (times == nullptr) return spec.budget;
  if (times->are_zero) return {};
  const auto number = static_cast<std::uint64_t>(release.count);
  return between(spec.min_time, spec.budget, mixed(times->seed, task.index, number));
}

}  // namespace chimera
