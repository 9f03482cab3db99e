// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/virtual/virtual_processor.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "chimera/runtime/testing/bare_tasks.h"

namespace chimera {
namespace {

using testing::kFirst;
using testing::kSecond;

class VirtualProcessorTest : public ::testing::Test, public testing::BareTasks {
 protected:
  VirtualProcessorTest() {
    for (const TaskId task : {kFirst, kSecond}) processor.of(task).remaining = milliseconds(10);
  }
  /// "TASK START LENGTH" in milliseconds of each slice since the last call, a line each.
  std::string slices() {
    std::vector<TapRecord> all(100);
    all.resize(reader.read(all));
    std::string text;
    for (const TapRecord& one : all) {
      EXPECT_EQ(one.kind, TapKind::kRun);
      text += std::to_string(one.task.index) + " " + std::to_string(one.at.count / 1'000'000) + " " +
              std::to_string(one.b / 1'000'000) + "\n";
    }
    return text;
  }

  VirtualProcessor processor{context_tap, 2};
};

TEST_F(VirtualProcessorTest, CountsTheTimeOfTheJob) {
  EXPECT_TRUE(processor.is_idle());
  EXPECT_FALSE(processor.running().is_valid());
  processor.give(kSecond, milliseconds(5));
  EXPECT_EQ(processor.running(), kSecond);
  EXPECT_EQ(processor.use(milliseconds(7)), milliseconds(2));
  EXPECT_EQ(processor.use(milliseconds(7)), Nanoseconds{});
  EXPECT_EQ(processor.use(milliseconds(8)), milliseconds(1));
  EXPECT_EQ(processor.counted_until(), milliseconds(8));
  EXPECT_EQ(processor.job().used, milliseconds(3));
  EXPECT_EQ(processor.of(kSecond).remaining, milliseconds(7));
  EXPECT_EQ(processor.of(kFirst).used, Nanoseconds{});
}

TEST_F(VirtualProcessorTest, RecordsOneSliceFromWhenItIsGivenToWhenItIsTaken) {
  processor.give(kFirst, milliseconds(1));
  (void)processor.use(milliseconds(2));
  (void)processor.use(milliseconds(4));
  EXPECT_EQ(slices(), "");
  processor.take();
  EXPECT_TRUE(processor.is_idle());
  processor.give(kSecond, milliseconds(4));
  (void)processor.use(milliseconds(5));
  processor.take();
  EXPECT_EQ(slices(), "0 1 3\n1 4 1\n");
}

TEST_F(VirtualProcessorTest, RecordsNoSliceWithoutTime) {
  processor.take();
  processor.give(kFirst, milliseconds(1));
  processor.take();
  EXPECT_EQ(slices(), "");
}

TEST_F(VirtualProcessorTest, ASliceContinuesAfterItIsRecorded) {
  processor.give(kFirst, milliseconds(1));
  (void)processor.use(milliseconds(2));
  processor.record_slice();
  EXPECT_EQ(processor.running(), kFirst);
  (void)processor.use(milliseconds(4));
  processor.take();
  EXPECT_EQ(slices(), "0 1 1\n0 2 2\n");
}

TEST_F(VirtualProcessorTest, DoesNotCountTimeBetweenTheSlicesOfAJob) {
  processor.give(kFirst, milliseconds(1));
  (void)processor.use(milliseconds(2));
  processor.record_slice();
  processor.resume(milliseconds(6));
  EXPECT_EQ(processor.use(milliseconds(7)), milliseconds(1));
  EXPECT_EQ(processor.job().used, milliseconds(2));
  processor.take();
  EXPECT_EQ(slices(), "0 1 1\n0 6 1\n");
}

}  // namespace
}  // namespace chimera
