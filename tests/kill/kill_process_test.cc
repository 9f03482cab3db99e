// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/kill/kill_trial.h"
#include "tests/kill/stop_trial.h"

namespace chimera {
namespace {

TEST(KilledWriter, LeavesNeitherATornNorAnUnreadableGroup) {
  const KillReport report = run_kill_trial({.kills = 2000});
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.kills, 2000u);
  EXPECT_GT(report.mid_write, 0u) << "otherwise nothing was shown";
  RecordProperty("mid_write", std::to_string(report.mid_write));
  EXPECT_GE(report.reads, 4000u);
  EXPECT_EQ(report.torn, 0u);
  EXPECT_EQ(report.backwards, 0u);
  EXPECT_EQ(report.refused_dead, 0u);
}

TEST(KilledWriter, AWriterThatFillsThePublishedSlotIsDetected) {
  const KillReport report = run_kill_trial({.kills = 20, .seconds = 60, .planted_defect = true});
  EXPECT_EQ(report.failure, "");
  EXPECT_GT(report.torn, 0u);
}

TEST(StoppedWriter, AReplacedWriterReachesNoReader) {
  const StopReport report = run_stop_trial({.stops = 200});
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.stops, 200u);
  EXPECT_GT(report.mid_write, 0u) << "otherwise nothing was shown";
  RecordProperty("mid_write", std::to_string(report.mid_write));
  EXPECT_GE(report.reads, 800u);
  EXPECT_EQ(report.torn, 0u);
  EXPECT_EQ(report.backwards, 0u);
}

TEST(StoppedWriter, AWriterThatSharesTheGroupOfItsSuccessorIsDetected) {
  const StopReport report = run_stop_trial({.stops = 20, .seconds = 60, .planted_defect = true});
  EXPECT_EQ(report.failure, "");
  EXPECT_GT(report.torn, 0u);
}

}  // namespace
}  // namespace chimera
