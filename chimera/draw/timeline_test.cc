// SPDX-License-Identifier: Apache-2.0
#include "chimera/draw/timeline.h"

#include <gtest/gtest.h>

namespace chimera::draw {
namespace {

TapRecord run(std::uint32_t task, std::int64_t at_ms, std::int64_t for_ms) {
  TapRecord record;
  record.kind = TapKind::kRun;
  record.task = TaskId(task);
  record.at = milliseconds(at_ms);
  record.b = milliseconds(for_ms).count;
  return record;
}

const std::vector<std::string> kTasks{"alpha", "beta"};

TEST(Timeline, ShowsOneLetterPerUnit) {
  const std::vector<TapRecord> records{run(0, 100, 2), run(1, 103, 4)};
  const Timeline drawn = timeline(records, kTasks, milliseconds(100), milliseconds(1), milliseconds(9));
  EXPECT_EQ(drawn.letters, "AA.BBBB..");
}

TEST(Timeline, TheLongestOfAnRtpuWins) {
  const std::vector<TapRecord> records{run(0, 0, 4), run(1, 4, 6), run(0, 10, 5), run(1, 15, 5)};
  EXPECT_EQ(timeline(records, kTasks, {}, milliseconds(10), milliseconds(20)).letters, "BA");
}

TEST(Timeline, ClipsRunsOutsideTheWindow) {
  const std::vector<TapRecord> records{run(0, 0, 12), run(1, 15, 100)};
  EXPECT_EQ(timeline(records, kTasks, milliseconds(10), milliseconds(1), milliseconds(8)).letters, "AA...BBB");
}

TEST(Timeline, LooksAtRunsOnly) {
  TapRecord release = run(0, 0, 5);
  release.kind = TapKind::kRelease;
  EXPECT_EQ(timeline(std::vector{release}, kTasks, {}, milliseconds(1), milliseconds(3)).letters, "...");
}

TEST(Timeline, SharedFirstLettersAreReplacedByTheAlphabet) {
  const std::vector<std::string> tasks{"pid", "plan", "arm"};
  const std::vector<TapRecord> records{run(0, 0, 1), run(1, 1, 1), run(2, 2, 1)};
  const Timeline drawn = timeline(records, tasks, {}, milliseconds(1), milliseconds(3));
  EXPECT_EQ(drawn.letters, "ABC");
  EXPECT_EQ(text(drawn), "       0  ABC\n          A = pid\n          B = plan\n          C = arm\n"
                         "          . = idle\n");
}

TEST(Timeline, BreaksLinesAtSixtyUnits) {
  const Timeline drawn = timeline({}, {}, {}, milliseconds(1), milliseconds(61));
  EXPECT_EQ(text(drawn), "       0  " + std::string(60, '.') + "\n      60  .\n          . = idle\n");
}

TEST(Timeline, TasksWithoutALetterOfTheirOwnShareALineOfTheLegend) {
  std::vector<std::string> tasks;
  for (int i = 0; i < 65; ++i) tasks.push_back("t" + std::to_string(i));
  const std::string said = text(timeline({}, tasks, {}, milliseconds(1), milliseconds(2)));
  EXPECT_NE(said.find("          9 = t61\n          ? = t62 and 2 more\n          . = idle\n"), std::string::npos)
      << said;
}

}  // namespace
}  // namespace chimera::draw
