// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/record/context_tap.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera::context_tap_test {
namespace {

constexpr TaskId kFirst{0u}, kSecond{1u};
constexpr std::uint32_t kPayload = 16;

/// Two tasks that publish 16 bytes; tap of rtpu 3.
class ContextTapTest : public ::testing::Test {
 protected:
  ContextTapTest() {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      tasks[i].id = TaskId(i);
      tasks[i].group = GroupWriter(memory[i].bytes, kPayload);
    }
  }
  void publish(TaskId task, std::int64_t value) {
    const std::int64_t values[2] = {value, value};
    tasks[task.index].group.write(reinterpret_cast<const std::byte*>(values), {}, 1);
  }
  std::vector<TapRecord> records() {
    std::vector<TapRecord> all(100);
    all.resize(reader.read(all));
    return all;
  }

  struct Memory {
    alignas(64) std::array<std::byte, group_bytes(kPayload)> bytes{};
  };
  Memory memory[2];
  std::array<Task, 2> tasks;
  std::unique_ptr<TapRing> ring = std::make_unique<TapRing>();
  Tap ring_tap{*ring};
  TapReader reader{*ring};
  HeapMemory heap;
};

TEST_F(ContextTapTest, RecordsUnderTheNumberOfItsRtpu) {
  ContextTap tap(tasks, &ring_tap, 3, false, heap);
  EXPECT_TRUE(tap.is_on());
  tap.record(TapKind::kMiss, milliseconds(5), kSecond, 7, -8);
  const auto all = records();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].kind, TapKind::kMiss);
  EXPECT_EQ(all[0].at, milliseconds(5));
  EXPECT_EQ(all[0].task, kSecond);
  EXPECT_EQ(all[0].a, 7u);
  EXPECT_EQ(all[0].b, -8);
  EXPECT_EQ(all[0].rtpu, 3);
}

TEST_F(ContextTapTest, WithoutATapDoesNothing) {
  ContextTap tap(tasks, nullptr, 3, true, heap);
  EXPECT_FALSE(tap.is_on());
  publish(kFirst, 1);
  tasks[0].is_tapped = true;
  tap.record(TapKind::kMiss, {}, kFirst, 0);
  tap.record_now(TapKind::kMiss, {}, kFirst, 0);
  tap.append_row(tasks[0]);
  tap.flush(kFirst);
  EXPECT_TRUE(records().empty());
}

TEST_F(ContextTapTest, KeepsRecordsOfABusyTaskUntilTheyAreFlushed) {
  ContextTap tap(tasks, &ring_tap, 0, true, heap);
  tasks[0].is_busy = true;
  tap.record(TapKind::kMiss, milliseconds(1), kFirst, 0);
  tap.record(TapKind::kFault, milliseconds(2), kFirst, 0);
  EXPECT_TRUE(records().empty());
  tap.record(TapKind::kDrop, milliseconds(3), kSecond, 1);
  tap.record(TapKind::kFlag, milliseconds(4), TaskId(), 1);
  tap.record_now(TapKind::kOverrun, milliseconds(5), kFirst, 0);
  auto all = records();
  ASSERT_EQ(all.size(), 3u) << "another task, none, and past those that are kept";
  EXPECT_EQ(all[2].kind, TapKind::kOverrun);
  tap.flush(kFirst);
  tap.flush(kFirst);
  all = records();
  ASSERT_EQ(all.size(), 2u) << "once";
  EXPECT_EQ(all[0].kind, TapKind::kMiss);
  EXPECT_EQ(all[1].kind, TapKind::kFault);
}

TEST_F(ContextTapTest, WithoutThreadsNothingIsKept) {
  ContextTap tap(tasks, &ring_tap, 0, false, heap);
  tasks[0].is_busy = true;
  tap.record(TapKind::kMiss, {}, kFirst, 0);
  EXPECT_EQ(records().size(), 1u);
}

TEST_F(ContextTapTest, AppendsEveryPublicationOnceAndNumbersThem) {
  ContextTap tap(tasks, &ring_tap, 0, true, heap);
  tap.append_row(tasks[0]);
  EXPECT_TRUE(records().empty()) << "nothing was published";
  publish(kFirst, 42);
  tap.append_row(tasks[0]);
  tap.append_row(tasks[0]);
  auto all = records();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].kind, TapKind::kGroup);
  EXPECT_EQ(all[0].row, 0u);
  EXPECT_EQ(all[2].kind, TapKind::kValue);
  EXPECT_EQ(all[2].b, 42);
  publish(kFirst, 43);
  tap.flush(kFirst);
  EXPECT_TRUE(records().empty()) << "the task is not tapped";
  tasks[0].is_tapped = true;
  tap.flush(kFirst);
  all = records();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].row, 1u);
}

}  // namespace
}  // namespace chimera::context_tap_test
