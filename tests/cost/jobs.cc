// SPDX-License-Identifier: Apache-2.0
// Runs ten small tasks of 1 kHz, each reading six values of the one before it, for a stated time: what
// tests/cost/instructions.py counts the instructions of. The clock of the executive is stepped, so that every run is
// the same to the instruction.
//
//   jobs virtual|executive|preemptive MILLISECONDS
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "bench/tasks.h"
#include "chimera/platform/clock.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/virtual/virtual_executor.h"

namespace chimera::bench {
namespace {

constexpr std::uint32_t kTasks = 10;

std::uint64_t cycles(TaskSet& set) {
  std::uint64_t sum = 0;
  for (const Task& task : set.tasks()) sum += task.profile.cycles;
  return sum;
}

std::uint64_t run_virtual(Nanoseconds duration, bool preemptive) {
  Axes axes(kTasks, [](std::uint32_t) { return milliseconds(1); });
  VirtualOptions how;
  how.preemptive = preemptive;
  VirtualExecutor executor(axes.set(), {}, how);
  if (!executor.start()) std::exit(1);
  executor.run(duration);
  return cycles(axes.set());
}

std::uint64_t run_executive(Nanoseconds duration) {
  Axes axes(kTasks, [](std::uint32_t) { return milliseconds(1); });
  VirtualClock clock;
  ComputingClock job_clock(clock);
  Executive executive(axes.set(), clock, job_clock, {});
  if (!executive.start()) std::exit(1);
  executive.run(duration);
  return cycles(axes.set());
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera;
  using namespace chimera::bench;
  const std::string_view how = argc == 3 ? argv[1] : "";
  const Nanoseconds duration = milliseconds(argc == 3 ? std::atoi(argv[2]) : 0);
  std::uint64_t done = 0;
  if (how == "virtual" || how == "preemptive") done = run_virtual(duration, how == "preemptive");
  else if (how == "executive") done = run_executive(duration);
  std::printf("%llu\n", static_cast<unsigned long long>(done));
  return done > 0 ? 0 : 2;
}
