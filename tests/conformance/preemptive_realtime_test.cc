// SPDX-License-Identifier: Apache-2.0
// The preemptive executor with real-time levels against preemptive virtual time: the same sets, the same schedule.
// Counts and order are judged, durations are not, and nothing while the host did not let even the witness run in time.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/conformance/by_threads.h"
#include "tests/conformance/classic_set.h"
#include "tests/conformance/judged.h"

namespace chimera::toy {
namespace {

Schedule by_threads(Policy policy) {
  Application app;
  add_classic_set(app, false, OnMiss::kAbort, kGrace);
  ProcessorPlace place = checked_place();
  place.quantum = kUnit;
  const Left left = run_by_threads(app, policy, kUnit * kUnits, place);
  Schedule schedule = schedule_of(left.records, left.origin);
  schedule.counts = left.counts;
  return schedule;
}

class PreemptiveSchedule : public ::testing::TestWithParam<Policy> {};

// Under least laxity a job changes places when what it has used, as the kernel counts it, is rounded to another quantum
// than in virtual time, in every second to fourth run: one of sixteen must be exact, none may miss what is critical.
// Under the other policies one of three must be: the host may take the processor for a unit unseen by the witness.
TEST_P(PreemptiveSchedule, IsThatOfVirtualTimeUnitByUnit) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const Schedule wanted = by_virtual_time(Kind::kPreemptive, GetParam(), OnMiss::kAbort);
  std::string seen;
  for (int left = GetParam() == Policy::kMufLaxity ? 16 : 3; left > 0 && seen != wanted.timeline; --left) {
    const auto got = judged(kGap, [] { return by_threads(GetParam()); });
    if (!got) GTEST_SKIP() << "not judged: host stalled";
    seen = got->timeline;
    if (seen != wanted.timeline) std::printf("differs: %s instead of %s\n", seen.c_str(), wanted.timeline.c_str());
    for (std::size_t i = 0; i < 3; ++i) {  // the critical ones
      if (wanted.missed[i] > 0) continue;
      EXPECT_EQ(got->missed[i], 0u) << "task " << static_cast<char>('A' + i);
    }
    EXPECT_EQ(got->counts.section_taken, 0u) << "the kernel's order excludes";
    EXPECT_EQ(got->counts.wrong_levels, 0u);
    EXPECT_GT(got->counts.checked, 60u);
  }
  EXPECT_EQ(seen, wanted.timeline);
}

INSTANTIATE_TEST_SUITE_P(Of, PreemptiveSchedule,
                         ::testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity), name_of);

}  // namespace
}  // namespace chimera::toy
