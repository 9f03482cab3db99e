// SPDX-License-Identifier: Apache-2.0
// The preemptive executor with real-time levels against preemptive virtual time: the same sets, the same schedule.
// Counts and order are judged, durations are not, and nothing while the host did not let even the witness run in time.
#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/runner.h"
#include "tests/conformance/witness.h"

namespace chimera::toy {
namespace {

constexpr int kTries = 5, kCeiling = 49;
constexpr Nanoseconds kRest = milliseconds(500);  // real-time threads are throttled above 0.95 of a second
constexpr Nanoseconds kGap = microseconds(1600);  // a fifth of a unit
constexpr Nanoseconds kUnit = milliseconds(8), kHalf = milliseconds(4);
constexpr int kUnits = 60;

int last_cpu() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())) - 1; }

ProcessorPlace place() {
  ProcessorPlace made;
  made.cpu = last_cpu();
  made.ceiling = kCeiling;
  made.base = 30;
  made.quantum = kUnit;
  made.checks = true;
  return made;
}

// A job ends a little after the end of a unit, when what is released there has come: as in virtual time, where a
// release at the instant of an end is seen by the dispatch that follows. Deadlines have as much grace, all the same.
constexpr Nanoseconds kAfter = microseconds(300), kHalfAfter = microseconds(150), kGrace = milliseconds(1);

// The classic set of the MUF literature.
void add_classic_set(Application& app, bool in_units, Nanoseconds grace) {
  const struct { const char* name; int period, units; std::uint32_t criticality; } set[] = {
      {"A", 6, 2, 2}, {"B", 10, 4, 2}, {"C", 12, 3, 2}, {"D", 15, 4, 0}};
  for (const auto& one : set) {
    TaskSpec& spec = app.add(one.name, kUnit * one.period, in_units ? kUnit * one.units : Nanoseconds{});
    spec.budget = kUnit * one.units;
    spec.deadline = spec.period + grace;
    spec.criticality = one.criticality;
    spec.on_miss = OnMiss::kAbort;
  }
}

// Computes for whole units of the grid, in which it had the processor: they add up to no drift.
int compute(const chimera_call& call, Nanoseconds origin, Nanoseconds work) {
  LinuxClock clock;
  Nanoseconds had, last = clock.now();
  const auto unit_of = [&](Nanoseconds t) { return (t - origin - kAfter).count / kUnit.count; };
  for (;;) {
    const Nanoseconds now = clock.now();
    if (now - last < milliseconds(1)) had += now - last;  // else others had it
    if (unit_of(now) != unit_of(last) && had > work - kHalf) return CHIMERA_OK;
    if (call.host->expired(call.context)) return CHIMERA_ABORTED;
    last = now;
  }
}

// The task that had most of each unit.
std::string timeline(const std::vector<TapRecord>& records, Nanoseconds origin) {
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
    line += *most == 0 ? '.' : static_cast<char>('A' + (most - unit.begin()));
  }
  return line;
}

// Misses by task, but for those at the very end.
std::array<std::uint64_t, 4> missed(const std::vector<TapRecord>& records, Nanoseconds origin) {
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

Schedule by_virtual_time(Policy policy) {
  Application app;
  add_classic_set(app, true, {});
  VirtualOptions how;
  how.quantum = kUnit;
  Runner run(app.build(), Kind::kPreemptive, policy, {}, how);
  EXPECT_TRUE(run.start());
  run.run(kUnit * kUnits);
  Schedule schedule;
  const auto records = run.records();
  schedule.timeline = timeline(records, Nanoseconds{} - kHalfAfter);
  schedule.missed = missed(records, {});
  return schedule;
}

Schedule by_threads(Policy policy) {
  Application app;
  add_classic_set(app, false, kGrace);
  auto ring = std::make_unique<TapRing>();
  Tap tap(*ring);
  TapReader reader(*ring);
  RunOptions options;
  options.policy = policy;
  options.tap = &tap;
  TaskSet& set = app.build_preemptive();
  Nanoseconds origin;
  for (const char* name : {"A", "B", "C", "D"})
    app.toy(name).during = [&origin, budget = app.task(name).spec->budget](const chimera_call& call) {
      return compute(call, origin, budget);
    };
  PreemptiveExecutor executor(set, options, place());
  Schedule schedule;
  std::thread edges([&] {
    enter_realtime({kCeiling, last_cpu(), false});
    if (!executor.start()) return;
    origin = executor.origin();
    executor.run(kUnit * kUnits);
  });
  edges.join();
  std::vector<TapRecord> records(kTapRecords);
  records.resize(reader.read(records));
  schedule.timeline = timeline(records, executor.origin());
  schedule.missed = missed(records, executor.origin());
  schedule.counts = executor.counts();
  return schedule;
}

// A schedule during which the host kept its word, as `judges` finds it; nothing after kTries that did not.
std::optional<Schedule> judged(Policy policy) {
  Nanoseconds worst;
  for (int i = 0; i < kTries; ++i) {
    LinuxClock().wait_until(LinuxClock().now() + kRest);
    Witness witness;
    const Schedule schedule = by_threads(policy);
    worst = witness.worst();
    if (worst <= kGap) return schedule;
    std::printf("try %d: the witness was %lld us late\n", i + 1, static_cast<long long>(worst.count / 1000));
  }
  std::printf("not judged: host stalled %lld us\n", static_cast<long long>(worst.count / 1000));
  return std::nullopt;
}

class PreemptiveSchedule : public testing::TestWithParam<Policy> {};

TEST_P(PreemptiveSchedule, IsThatOfVirtualTimeUnitByUnit) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const Schedule wanted = by_virtual_time(GetParam());
  const auto got = judged(GetParam());
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(got->timeline, wanted.timeline);
  for (std::size_t i = 0; i < 3; ++i) {  // the critical ones
    if (wanted.missed[i] > 0) continue;
    EXPECT_EQ(got->missed[i], 0u) << "task " << static_cast<char>('A' + i);
  }
  EXPECT_EQ(got->counts.section_taken, 0u) << "the kernel's order excludes";
  EXPECT_EQ(got->counts.wrong_levels, 0u);
  EXPECT_GT(got->counts.checked, 60u);
}

std::string name_of(const testing::TestParamInfo<Policy>& one) {
  const char* const names[] = {"Rm", "Edf", "Llf", "Muf", "MufLaxity"};
  return names[static_cast<int>(one.param)];
}

INSTANTIATE_TEST_SUITE_P(Of, PreemptiveSchedule,
                         testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity), name_of);

}  // namespace
}  // namespace chimera::toy
