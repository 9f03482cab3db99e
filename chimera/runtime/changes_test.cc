// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/changes.h"

#include <gtest/gtest.h>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera {
namespace {

constexpr TaskId kFirst{0u}, kSecond{1u};
constexpr TaskStatus kOff{State::kOff, false, 1}, kOn{State::kOn, false, 1}, kError{State::kError, false, 1};

struct ChangesTest : ::testing::Test {
  ChangesTest() { changes.prepare(2, heap); }
  HeapMemory heap;
  Changes changes;
};

TEST_F(ChangesTest, StandInTheOrderInWhichTheyCame) {
  changes.add_fault(kSecond);
  changes.add_status(kFirst, kOff, kOn);
  changes.add_flag();
  ASSERT_EQ(changes.list().size(), 3u);
  EXPECT_EQ(changes.list()[0].kind, Change::Kind::kFault);
  EXPECT_EQ(changes.list()[0].task, kSecond);
  EXPECT_EQ(changes.list()[1].before, kOff);
  EXPECT_EQ(changes.list()[1].now, kOn);
  EXPECT_EQ(changes.list()[2].kind, Change::Kind::kFlag);
}

TEST_F(ChangesTest, ATaskThatChangesTwiceIsListedOnceWithItsLatestStatus) {
  changes.add_status(kFirst, kOff, kOn);
  changes.add_status(kSecond, kOff, kOn);
  changes.add_status(kFirst, kOn, kError);
  ASSERT_EQ(changes.list().size(), 2u);
  EXPECT_EQ(changes.list()[0].before, kOff);
  EXPECT_EQ(changes.list()[0].now, kError);
}

TEST_F(ChangesTest, NeverNeedsMoreRoomThanWasReserved) {
  const Change* place = nullptr;
  for (int i = 0; i < 10; ++i) {
    for (const TaskId task : {kFirst, kSecond}) {
      changes.add_fault(task);
      changes.add_status(task, kOff, i % 2 == 0 ? kOn : kError);
    }
    changes.add_flag();
    if (place == nullptr) place = changes.list().data();
    EXPECT_EQ(changes.list().data(), place);
  }
  EXPECT_EQ(changes.list().size(), 5u);
  changes.clear();
  EXPECT_TRUE(changes.is_empty());
}

TEST(Changes, WithoutAPublisherNothingIsListed) {
  Changes unwanted;
  unwanted.add_flag();
  unwanted.add_status(kFirst, kOff, kOn);
  EXPECT_TRUE(unwanted.is_empty());
}

}  // namespace
}  // namespace chimera
