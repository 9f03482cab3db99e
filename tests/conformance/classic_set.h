// SPDX-License-Identifier: Apache-2.0
// The classic set of the MUF literature in real time, so that its schedule can be compared unit by unit with virtual
// time; and the timeline that a run left on the tap.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <thread>

#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/runner.h"
#include "tests/conformance/witness.h"

namespace chimera::toy {

inline constexpr int kTries = 5, kCeiling = 49;
inline constexpr Nanoseconds kRest = milliseconds(500);  // real-time threads are throttled above 0.95 of a second
inline constexpr Nanoseconds kGap = microseconds(1600);  // a fifth of a unit
inline constexpr Nanoseconds kUnit = milliseconds(8), kHalf = milliseconds(4);
inline constexpr int kUnits = 60;

inline int last_cpu() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())) - 1; }

// A job ends a little after the end of a unit, when what is released there has come: as in virtual time, where a
// release at the instant of an end is seen by the dispatch that follows. Deadlines have as much grace, all the same.
inline constexpr Nanoseconds kAfter = microseconds(300), kHalfAfter = microseconds(150), kGrace = milliseconds(1);

// The classic set of the MUF literature.
inline void add_classic_set(Application& app, bool in_units, Nanoseconds grace, OnMiss on_miss = OnMiss::kAbort) {
  const struct { const char* name; int period, units; std::uint32_t criticality; } set[] = {
      {"A", 6, 2, 2}, {"B", 10, 4, 2}, {"C", 12, 3, 2}, {"D", 15, 4, 0}};
  for (const auto& one : set) {
    TaskSpec& spec = app.add(one.name, kUnit * one.period, in_units ? kUnit * one.units : Nanoseconds{});
    spec.budget = kUnit * one.units;
    spec.deadline = spec.period + grace;
    spec.criticality = one.criticality;
    spec.on_miss = on_miss;
  }
}

// Computes for whole units of the grid, in which it had the processor: they add up to no drift.
inline int compute(const chimera_call& call, Nanoseconds origin, Nanoseconds work, bool gives_up = true) {
  LinuxClock clock;
  Nanoseconds had, last = clock.now();
  const auto unit_of = [&](Nanoseconds t) { return (t - origin - kAfter).count / kUnit.count; };
  for (;;) {
    const Nanoseconds now = clock.now();
    if (now - last < milliseconds(1)) had += now - last;  // else others had it
    if (unit_of(now) != unit_of(last) && had > work - kHalf) return CHIMERA_OK;
    if (gives_up && call.host->expired(call.context)) return CHIMERA_ABORTED;
    last = now;
  }
}

// The task that had each unit, or the greater part of it.
inline std::string timeline(const std::vector<TapRecord>& records, Nanoseconds origin) {
  std::vector<std::array<std::int64_t, 4>> share(kUnits, std::array<std::int64_t, 4>{});
  for (const TapRecord& r : records) {
    if (r.kind != TapKind::kRun) continue;
    std::int64_t at = (r.at - origin - kHalfAfter).count, left = r.b;
    while (left > 0 && at / kUnit.count < kUnits) {
      const std::int64_t unit = at / kUnit.count, part = std::min(left, (unit + 1) * kUnit.count - at);
      share[static_cast<std::size_t>(unit)][r.task.index] += part;
      at += part;
      left -= part;
    }
  }
  std::string line;
  for (const auto& unit : share) {
    const auto most = std::max_element(unit.begin(), unit.end());
    line += *most < kHalf.count ? '.' : static_cast<char>('A' + (most - unit.begin()));
  }
  return line;
}

// Misses by task, but for those at the very end.
inline std::array<std::uint64_t, 4> missed(const std::vector<TapRecord>& records, Nanoseconds origin) {
  std::array<std::uint64_t, 4> n{};
  for (const TapRecord& r : records)
    if (r.kind == TapKind::kMiss && r.at < origin + kUnit * (kUnits - 1)) ++n[r.task.index];
  return n;
}

struct Schedule {
  std::string timeline;
  std::array<std::uint64_t, 4> missed{};
  ProcessorCounts counts;
};

// A schedule during which the host kept its word, as `run` made it; nothing after kTries that did not.
template <class Run>
std::optional<Schedule> judged(Run run) {
  Nanoseconds worst;
  for (int i = 0; i < kTries; ++i) {
    LinuxClock().wait_until(LinuxClock().now() + kRest);
    Witness witness;
    const Schedule schedule = run();
    worst = witness.worst();
    if (worst <= kGap) return schedule;
    std::printf("try %d: the witness was %lld us late\n", i + 1, static_cast<long long>(worst.count / 1000));
  }
  std::printf("not judged: host stalled %lld us\n", static_cast<long long>(worst.count / 1000));
  return std::nullopt;
}

inline std::string name_of(const testing::TestParamInfo<Policy>& one) {
  const char* const names[] = {"Rm", "Edf", "Llf", "Muf", "MufLaxity"};
  return names[static_cast<int>(one.param)];
}

}  // namespace chimera::toy
