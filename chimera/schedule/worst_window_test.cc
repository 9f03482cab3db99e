// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/worst_window.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace chimera::worst_window_test {
namespace {

Work work(std::int64_t period, std::int64_t time, std::uint32_t criticality) {
  return {.period = milliseconds(period), .deadline = milliseconds(period), .offset = {}, .time = milliseconds(time),
          .criticality = criticality, .user_priority = 0, .rtpu = 0, .server = {}};
}

std::string letters(const std::vector<Work>& works, const ProcessorUse& use, std::int64_t length) {
  std::vector<WindowTask> room(works.size());
  std::vector<WindowRun> runs(100);
  const std::vector<ProcessorUse> uses = {use};
  const WorstWindow window = worst_window(works, uses, 0, milliseconds(length), room, runs);
  std::string drawn(static_cast<std::size_t>(length), '.');
  for (std::size_t i = 0; i < window.runs; ++i)
    for (std::int64_t at = runs[i].from / milliseconds(1); at < runs[i].to / milliseconds(1); ++at)
      drawn[static_cast<std::size_t>(at)] = static_cast<char>('A' + runs[i].task);
  return drawn;
}

// The example of the MUF literature without its fourth task, which only makes the others late under `edf`.
const std::vector<Work> kSet = {work(6, 2, 2), work(10, 4, 2), work(12, 3, 2)};

TEST(WorstWindow, DrawsTheRunningTasksAfterASynchronousRelease) {
  EXPECT_EQ(letters(kSet, {.policy = Policy::kRm}, 12), "AABBBBAACCBB");
  EXPECT_EQ(letters(kSet, {.policy = Policy::kEdf}, 12), "AABBBBAACCCB");
}

TEST(WorstWindow, BeginsBehindTheLongestJobInAnExecutive) {
  EXPECT_EQ(letters(kSet, {.policy = Policy::kRm, .dispatch = Dispatch::kExecutive}, 9), "BBBBAAAAC");
}

TEST(WorstWindow, ShowsIdleTimeAndStopsWhenFull) {
  EXPECT_EQ(letters({work(5, 1, 0)}, {.policy = Policy::kEdf}, 7), "A....A.");
  std::vector<WindowTask> room(3);
  std::vector<WindowRun> runs(2);
  const std::vector<ProcessorUse> uses = {{.policy = Policy::kRm}};
  const WorstWindow window = worst_window(kSet, uses, 0, milliseconds(100), room, runs);
  EXPECT_EQ(window.runs, 2u);
  EXPECT_EQ(window.length, milliseconds(6));
}

}  // namespace
}  // namespace chimera::worst_window_test
