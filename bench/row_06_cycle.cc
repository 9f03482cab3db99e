// SPDX-License-Identifier: Apache-2.0
// Row 6: what one cycle costs beyond the same copies and clock reads, profiling on, where tasks read each other through
// the register: judgement at the start, transfer in, body, judgement at the end, publication, profile.
#include "bench/bench.h"
#include "bench/tasks.h"
#include "chimera/platform/clock.h"
#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/executive/executive.h"

namespace chimera::bench {
namespace {

void run(int repetitions) {
  AxesForm form;
  form.preemptive = true;  // copies
  Axes axes(2, [](std::uint32_t) { return milliseconds(1); }, form);
  LinuxClock clock;
  ComputingClock job_clock(clock);
  Releases releases(axes.set(), job_clock, {});
  if (!axes.set().life().start(clock.now())) std::exit(1);
  releases.begin(clock.now());
  Comparison cycles(repetitions);
  alignas(64) std::array<double, 16> in{}, local{}, out{}, published{};
  const std::size_t bytes = kAxes * sizeof(double);
  const auto copy = [](void* to, const void* from, std::size_t n) {
    asm volatile("" : "+r"(n));  // a length known at run time only, as the register's
    std::memcpy(to, from, n);
  };
  const auto raw = cycles.add("copies, body, two clock reads", [&](std::uint64_t n) {
    while (n--) {
      Nanoseconds start = clock.now();
      copy(local.data(), in.data(), bytes + sizeof(chimera_slot));
      for (int i = 0; i < kAxes; ++i) out[i] = 0.5 * local[i] + 1.0;
      copy(published.data(), out.data(), bytes);
      Nanoseconds end = clock.now();
      keep(start), keep(end), keep(published);
    }
  });
  const auto ours = cycles.add("cycle", [&](std::uint64_t n) {
    while (n--) {
      const Nanoseconds start = clock.now();
      const Job job{TaskId(0u), start, start + milliseconds(1)};
      if (!releases.may_start(job, start)) continue;
      CycleTime time;
      const BodyEnd body = releases.jobs().open_and_begin(job, time, false);
      const Nanoseconds end = clock.now();
      releases.end_job(job, time, body, start, end, end - start);
    }
  });
  cycles.run(raw);
  Figure f = Figure{.row = 6, .what = "one cycle, 48 B in and out through the register"}.of(cycles, ours);
  print(f);
  Figure added{.row = 6, .what = "what the framework adds to it", .goal = figure_at_most(60)};
  added.figure = cycles.cost(ours) - cycles.cost(raw);
  added.aa_spread = cycles.aa_spread();
  added.n = cycles.n();
  print(added);
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  chimera::bench::Stage stage;
  chimera::bench::run(chimera::bench::repetitions(argc, argv));
}
