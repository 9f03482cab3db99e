// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/background_writer.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>

#include "chimera/base/testing/await.h"

namespace chimera {
namespace {

struct Disk {
  std::atomic<int> calls{0};
  std::atomic<bool> is_stalled{false}, fails{false};
  std::atomic<int> policy{-1};
};

std::int32_t write(void* state, chimera_fault* fault) {
  Disk& disk = *static_cast<Disk*>(state);
  ++disk.calls;
  disk.policy = sched_getscheduler(0);
  while (disk.is_stalled) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  if (!disk.fails) return CHIMERA_OK;
  std::strcpy(fault->text, "it burns");
  return CHIMERA_FAULT;
}

void await(const Disk& disk, int calls) {
  ASSERT_TRUE(await_that([&] { return disk.calls >= calls; }));
}

struct BackgroundWriters : ::testing::Test {
  BackgroundWriter writer{milliseconds(1), kHangLimit};
  chimera_fault fault{};
};

TEST_F(BackgroundWriters, CallAgainAndAgainAndOnceMoreAtTheEnd) {
  Disk disk;
  ASSERT_TRUE(writer.add(&disk, write));
  await(disk, 3);
  EXPECT_EQ(disk.policy, SCHED_OTHER);
  EXPECT_EQ(writer.remove(&disk, fault), BackgroundWriter::End::kDone);
  EXPECT_STREQ(fault.text, "");
  const int calls = disk.calls;
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(disk.calls, calls);
}

TEST_F(BackgroundWriters, CallOnceEvenWhenTheEndComesAtOnce) {
  Disk disk;
  BackgroundWriter slow(seconds(3600), kHangLimit);
  ASSERT_TRUE(slow.add(&disk, write));
  EXPECT_EQ(slow.remove(&disk, fault), BackgroundWriter::End::kDone);
  EXPECT_EQ(disk.calls, 1);
}

TEST_F(BackgroundWriters, DoNotCallAFailedMethodAgainAndNameItsFault) {
  Disk disk;
  disk.fails = true;
  ASSERT_TRUE(writer.add(&disk, write));
  await(disk, 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(writer.remove(&disk, fault), BackgroundWriter::End::kFault);
  EXPECT_STREQ(fault.text, "it burns");
  EXPECT_EQ(disk.calls, 1);
}

TEST_F(BackgroundWriters, DoNotWaitForAStalledOneNorLetItHoldUpOthers) {
  BackgroundWriter impatient(milliseconds(1), milliseconds(200));
  static Disk other, stalled;  // must stay: a thread may be in them
  stalled.is_stalled = true;
  ASSERT_TRUE(impatient.add(&stalled, write, 17));
  ASSERT_TRUE(impatient.add(&other, write, 18));
  await(stalled, 1);
  await(other, 5);
  EXPECT_TRUE(await_that([&] { return impatient.longest(milliseconds(10)) == 17; }));
  EXPECT_EQ(impatient.longest(seconds(3600)), 0u) << "not for an hour";
  EXPECT_EQ(impatient.remove(&stalled, fault), BackgroundWriter::End::kStalled);
  EXPECT_STREQ(fault.text, "its background did not return within 0.2 s: what it holds is lost");
  const int calls = other.calls;
  await(other, calls + 3);
  EXPECT_NE(impatient.remove(&other, fault), BackgroundWriter::End::kFault);  // the machine may stall as well
  stalled.is_stalled = false;
}

}  // namespace
}  // namespace chimera
