// SPDX-License-Identifier: Apache-2.0
// The classic set of the MUF literature in real time, so that its schedule can be compared unit by unit with virtual
// time.
#pragma once

#include <array>
#include <string>

#include "chimera/platform/clock.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/runner.h"
#include "tests/conformance/timeline.h"

namespace chimera::toy {

inline constexpr Nanoseconds kGap = microseconds(1600);  // a fifth of a unit
inline constexpr Nanoseconds kUnit = milliseconds(8), kHalf = milliseconds(4);
inline constexpr int kUnits = 60;

// A job ends a little after the end of a unit, when what is released there has come: as in virtual time, where a
// release at the instant of an end is seen by the dispatch that follows. Deadlines have as much grace, all the same.
inline constexpr Nanoseconds kAfter = microseconds(300), kHalfAfter = microseconds(150), kGrace = milliseconds(1);

// Computes for whole units of the grid of releases, in which it had the processor: they add up to no drift.
inline int compute(const chimera_call& call, Nanoseconds work, bool gives_up) {
  LinuxClock clock;
  Nanoseconds had, last = clock.now();
  const auto unit_of = [&](Nanoseconds t) { return (t - Nanoseconds{call.now_ns} - kAfter).count / kUnit.count; };
  for (;;) {
    const Nanoseconds now = clock.now();
    if (now - last < milliseconds(1)) had += now - last;  // else others had it
    if (unit_of(now) != unit_of(last) && had > work - kHalf) return CHIMERA_OK;
    if (gives_up && call.host->expired(call.context)) return CHIMERA_ABORTED;
    last = now;
  }
}

/// The set for virtual time, or for real time with so much grace.
inline void add_classic_set(Application& app, bool in_virtual_time, OnMiss on_miss, Nanoseconds grace = {}) {
  const struct { const char* name; int period, units; std::uint32_t criticality; } set[] = {
      {"A", 6, 2, 2}, {"B", 10, 4, 2}, {"C", 12, 3, 2}, {"D", 15, 4, 0}};
  for (const auto& one : set) {
    const Nanoseconds work = kUnit * one.units;
    TaskSpec& spec = app.add(one.name, kUnit * one.period, in_virtual_time ? work : Nanoseconds{});
    spec.budget = work;
    spec.deadline = spec.period + grace;
    spec.criticality = one.criticality;
    spec.on_miss = on_miss;
    if (in_virtual_time) continue;
    app.toy(one.name).during = [work, gives_up = on_miss == OnMiss::kAbort](const chimera_call& call) {
      return compute(call, work, gives_up);
    };
  }
}

struct Schedule {
  std::string timeline;
  std::array<std::uint64_t, 4> missed{};  // by task, but for those at the very end
  ProcessorCounts counts;
};

inline std::string classic_timeline(const std::vector<TapRecord>& records, Nanoseconds origin,
                                    const std::string& names = "ABCD") {
  return timeline(records, origin + kHalfAfter, kUnit, names, kUnits, 2);
}

inline Schedule schedule_of(const std::vector<TapRecord>& records, Nanoseconds origin) {
  Schedule schedule;
  schedule.timeline = classic_timeline(records, origin);
  for (const TapRecord& r : records)
    if (r.kind == TapKind::kMiss && r.at < origin + kUnit * (kUnits - 1)) ++schedule.missed[r.task.index];
  return schedule;
}

inline Schedule by_virtual_time(Kind kind, Policy policy, OnMiss on_miss) {
  Application app;
  add_classic_set(app, true, on_miss);
  VirtualOptions how;
  how.quantum = kUnit;
  Runner run(app.build(), kind, policy, {}, how);
  EXPECT_TRUE(run.start());
  run.run(kUnit * kUnits);
  return schedule_of(run.records(), {});
}

}  // namespace chimera::toy
