// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/tap_rows.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory>
#include <random>

#include "chimera/runtime/record/tap_ring.h"

namespace chimera::tap_rows_test {
namespace {

constexpr std::uint32_t kBytes[] = {24, 8, 0};
constexpr std::uint32_t kTasks = 3;

struct Published {
  chimera_slot slot{};
  std::int64_t values[3] = {};
};

struct Rows : ::testing::Test {
  std::unique_ptr<TapRing> ring = std::make_unique<TapRing>();
  Tap tap{*ring};
  TapReader reader{*ring};
  TapRows rows{kBytes};
  std::uint32_t appended[kTasks] = {};

  // Row n of a task carries n in every place.
  void publish(std::uint32_t task) {
    const std::uint32_t n = appended[task]++;
    Published p;
    p.slot.published_ns = n * 10;
    p.slot.sequence = n + 100;
    for (std::int64_t& v : p.values) v = n;
    tap.append_row(p.slot, kBytes[task], TaskId{task}, 4, n);
  }
  std::vector<TapRecord> records() {
    std::vector<TapRecord> all;
    TapRecord some[64];
    for (std::size_t n; (n = reader.read(some)) > 0;) all.insert(all.end(), some, some + n);
    return all;
  }
  static bool is_whole(const TapRow& row) {
    if (row.sequence != row.number + 100 || row.at.count != row.number * 10) return false;
    for (std::size_t i = 0; i < row.payload.size(); i += 8) {
      std::int64_t value;
      std::memcpy(&value, row.payload.data() + i, 8);
      if (value != row.number) return false;
    }
    return row.payload.size() == kBytes[row.task.index];
  }
};

TEST_F(Rows, ComeOutAsTheyWerePublished) {
  publish(0);
  publish(2);
  tap.append({.at = {}, .b = 3, .a = 1, .task = TaskId{0u}, .kind = TapKind::kRun});
  publish(1);
  const auto all = records();
  ASSERT_EQ(all.size(), 4u + 1 + 1 + 2);
  EXPECT_EQ(all[0].rtpu, 4);
  std::vector<std::uint32_t> tasks;
  for (const TapRecord& r : all) {
    if (const TapRow* row = rows.take(r)) {
      EXPECT_TRUE(is_whole(*row));
      tasks.push_back(row->task.index);
    }
  }
  EXPECT_EQ(tasks, (std::vector<std::uint32_t>{0, 2, 1}));
}

TEST_F(Rows, RecordsOfAnotherSizeOrTaskAreNoRows) {
  TapRecord r{.at = {}, .b = 1, .a = 2, .task = TaskId{0u}, .kind = TapKind::kGroup};
  EXPECT_EQ(rows.take(r), nullptr);
  r.kind = TapKind::kValue;
  for (r.a = 0; r.a < 3; ++r.a) EXPECT_EQ(rows.take(r), nullptr);
  r.task = TaskId{kTasks};
  EXPECT_EQ(rows.take(r), nullptr);
  r.task = TaskId{};
  EXPECT_EQ(rows.take(r), nullptr);
}

TEST_F(Rows, WithRandomLossAreWholeAndTheGapsAddUp) {
  std::mt19937 random(5);
  std::uint64_t out[kTasks] = {}, said[kTasks] = {};
  std::uint32_t first[kTasks] = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, last[kTasks] = {};
  for (int round = 0; round < 2000; ++round) {
    for (int i = 0; i < 10; ++i) publish(static_cast<std::uint32_t>(random() % kTasks));
    for (const TapRecord& r : records()) {
      if (random() % 20 == 0) continue;  // lost
      const TapRow* row = rows.take(r);
      if (row == nullptr) continue;
      ASSERT_TRUE(is_whole(*row));
      const std::uint32_t t = row->task.index;
      first[t] = std::min(first[t], row->number);
      last[t] = row->number;
      ++out[t];
      said[t] += row->lost;
    }
  }
  for (std::uint32_t t = 0; t < kTasks; ++t) {
    EXPECT_GT(out[t], 4000u);
    EXPECT_EQ(out[t] + said[t], last[t] - first[t] + 1u);
    EXPECT_EQ(rows.lost(TaskId{t}), said[t]);
    EXPECT_GT(said[t], 100u);
  }
}

TEST_F(Rows, ARingThatWasOvertakenLeavesOneGap) {
  publish(1);
  for (const TapRecord& r : records()) rows.take(r);
  for (std::size_t i = 0; i < kTapRecords; ++i) publish(1);  // two records each
  const TapRow* first = nullptr;
  for (const TapRecord& r : records()) {
    const TapRow* row = rows.take(r);
    if (row != nullptr && first == nullptr) {
      first = row;
      EXPECT_EQ(row->number, 1 + row->lost);
      EXPECT_GE(row->lost, kTapRecords / 2);
    }
  }
  EXPECT_EQ(rows.lost(TaskId{1u}) + 1, appended[1] - (kTapRecords - 2) / 2);
}

TEST_F(Rows, RandomRecordsNeverGiveHalfARow) {
  std::mt19937_64 random(6);
  std::uint64_t out = 0;
  for (int i = 0; i < 300'000; ++i) {
    TapRecord r;
    r.a = static_cast<std::uint32_t>(random() % 5);
    r.task = TaskId{static_cast<std::uint32_t>(random() % 5)};
    r.kind = static_cast<TapKind>(random() % 12);
    r.row = static_cast<std::uint32_t>(random() % 2);
    const TapRow* row = rows.take(r);
    if (row == nullptr) continue;
    ASSERT_EQ(row->payload.size(), kBytes[row->task.index]);
    ++out;
  }
  EXPECT_GT(out, 0u);
}

}  // namespace
}  // namespace chimera::tap_rows_test
