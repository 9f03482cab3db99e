// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job/miss_history.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TaskSpec tolerating(std::uint16_t misses, std::uint16_t of) {
  TaskSpec spec;
  spec.tolerated_misses = misses;
  spec.tolerated_of = of;
  return spec;
}

TEST(MissHistory, ToleratesAsManyMissesAsTheTaskSaysInItsLastCycles) {
  const TaskSpec spec = tolerating(2, 4);
  MissHistory history;
  EXPECT_TRUE(history.add(true, spec));
  EXPECT_TRUE(history.add(true, spec));
  EXPECT_FALSE(history.add(true, spec)) << "the third of four";
  EXPECT_FALSE(history.add(false, spec)) << "still three of four";
  EXPECT_TRUE(history.add(false, spec));
}

TEST(MissHistory, SaysWhetherAMissWouldBeToleratedAndAddsNone) {
  const TaskSpec spec = tolerating(1, 2);
  MissHistory history;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(history.would_tolerate(spec));
  EXPECT_TRUE(history.add(true, spec));
  EXPECT_FALSE(history.would_tolerate(spec));
  EXPECT_TRUE(history.add(false, spec)) << "would_tolerate() was no miss";
  EXPECT_TRUE(history.would_tolerate(spec));
}

TEST(MissHistory, LooksBackOver64CyclesAtMost) {
  const TaskSpec spec = tolerating(1, 64);
  MissHistory history;
  EXPECT_TRUE(history.add(true, spec));
  for (int i = 0; i < 62; ++i) EXPECT_TRUE(history.add(false, spec));
  EXPECT_FALSE(history.would_tolerate(spec)) << "the 64th cycle";
  EXPECT_TRUE(history.add(false, spec));
  EXPECT_TRUE(history.would_tolerate(spec)) << "the miss is 65 cycles ago then";
}

TEST(MissHistory, WithoutTolerationNoMissIsTolerated) {
  MissHistory history;
  EXPECT_FALSE(history.would_tolerate(tolerating(0, 0)));
  EXPECT_FALSE(history.add(true, tolerating(0, 0)));
}

}  // namespace
}  // namespace chimera
