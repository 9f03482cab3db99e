// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/switch/switch_record.h"

#include <gtest/gtest.h>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera::switch_record_test {
namespace {

TEST(StartDelays, ReportsTheLongestDelayOfAWindow) {
  HeapMemory memory;
  StartDelays delays;
  delays.prepare(2, memory);
  Task task;
  task.id = TaskId(1u);
  const auto starts = [&](std::int64_t us) { task.profile.start_delay.add(microseconds(us)); };
  EXPECT_EQ(delays.begin(task), Nanoseconds{-1}) << "no cycle yet";
  EXPECT_EQ(delays.look(task), Nanoseconds{-1});
  starts(5);
  EXPECT_EQ(delays.look(task), microseconds(5));
  starts(9);
  starts(2);
  EXPECT_EQ(delays.look(task), microseconds(9)) << "the longest of the run";
  EXPECT_EQ(delays.begin(task), microseconds(9));
  starts(3);
  EXPECT_EQ(delays.look(task), microseconds(3));
  starts(4);
  starts(8);
  EXPECT_EQ(delays.look(task), microseconds(6)) << "their mean";
  EXPECT_EQ(delays.look(task), Nanoseconds{-1});
  starts(50);
  delays.begin_later(task.id);
  EXPECT_EQ(delays.look(task), Nanoseconds{-1}) << "of before";
  task.profile.start_delay = {};  // spawned anew
  EXPECT_EQ(delays.look(task), Nanoseconds{-1});
  starts(1);
  EXPECT_EQ(delays.look(task), microseconds(1));
}

}  // namespace
}  // namespace chimera::switch_record_test
