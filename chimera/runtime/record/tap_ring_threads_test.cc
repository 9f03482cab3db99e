// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "chimera/runtime/record/tap_ring.h"

namespace chimera {
namespace {

TapRecord numbered_record(std::uint64_t number) {
  TapRecord record;
  record.at = Nanoseconds{static_cast<std::int64_t>(number)};
  record.b = ~static_cast<std::int64_t>(number);
  record.a = static_cast<std::uint32_t>(number);
  record.task = TaskId{~static_cast<std::uint32_t>(number)};
  return record;
}

bool is_whole(const TapRecord& r) {
  const auto number = static_cast<std::uint32_t>(r.at.count);
  return r.b == ~r.at.count && r.a == number && r.task.index == ~number;
}

struct TapRings : ::testing::Test {
  std::unique_ptr<TapRing> ring = std::make_unique<TapRing>();
};

TEST_F(TapRings, GiveBackRecordsInTheirOrder) {
  Tap tap(*ring);
  TapReader reader(*ring);
  for (std::uint64_t i = 0; i < 5; ++i) tap.append(numbered_record(i));
  std::array<TapRecord, 3> out;
  ASSERT_EQ(reader.read(out), 3u);
  EXPECT_EQ(out[2].at, Nanoseconds{2});
  ASSERT_EQ(reader.read(out), 2u);
  EXPECT_EQ(out[1].at, Nanoseconds{4});
  EXPECT_EQ(reader.read(out), 0u);
  EXPECT_EQ(reader.position(), 5u);
  EXPECT_EQ(reader.lost(), 0u);
}

TEST_F(TapRings, ManyReadersGetTheSameRecords) {
  Tap tap(*ring);
  TapReader early(*ring);
  tap.append(numbered_record(0));
  TapReader late(*ring), complete(*ring, true);
  tap.append(numbered_record(1));
  std::array<TapRecord, 8> out;
  EXPECT_EQ(early.read(out), 2u);
  EXPECT_EQ(complete.read(out), 2u);
  ASSERT_EQ(late.read(out), 1u);
  EXPECT_EQ(out[0].at, Nanoseconds{1});
}

TEST_F(TapRings, AReaderThatFallsBehindLosesTheOldestAndKnowsHowMany) {
  Tap tap(*ring);
  TapReader reader(*ring);
  constexpr std::uint64_t kAppended = 2 * kTapRecords + 10;
  for (std::uint64_t i = 0; i < kAppended; ++i) tap.append(numbered_record(i));
  std::vector<TapRecord> out(kAppended);
  const std::size_t n = reader.read(out);
  EXPECT_EQ(n, kTapRecords - 2);
  EXPECT_EQ(reader.lost(), kAppended - n);
  EXPECT_EQ(out[0].at.count, static_cast<std::int64_t>(reader.lost()));
  EXPECT_EQ(out[n - 1].at.count, static_cast<std::int64_t>(kAppended - 1));
}

TEST_F(TapRings, AReaderThatBeginsWithTheOldestHasLostNothing) {
  Tap tap(*ring);
  for (std::uint64_t i = 0; i < kTapRecords + 7; ++i) tap.append(numbered_record(i));
  TapReader reader(*ring, true);
  TapRecord out[1];
  ASSERT_EQ(reader.read(out), 1u);
  EXPECT_EQ(out[0].at, Nanoseconds{9});
  EXPECT_EQ(reader.lost(), 0u);
}

TEST_F(TapRings, AWriterThatTakesOverARingGoesOnCounting) {
  Tap(*ring).append(numbered_record(0));
  Tap(*ring).append(numbered_record(1));
  TapReader reader(*ring, true);
  std::array<TapRecord, 4> out;
  ASSERT_EQ(reader.read(out), 2u);
  EXPECT_EQ(out[1].at, Nanoseconds{1});
}

TEST_F(TapRings, RandomHeadsNeverLeadOutOfTheRingOrIntoALoop) {
  std::mt19937_64 random(2);
  for (TapRecord& r : ring->records) r.b = static_cast<std::int64_t>(random());
  std::array<TapRecord, 100> out;
  std::uint64_t n = 0;
  for (int round = 0; round < 20'000; ++round) {
    ring->head = round % 3 == 0 ? random() : ring->head + random() % 50'000;
    TapReader reader(*ring, round % 2 == 0);
    for (int i = 0; i < 3; ++i) {
      ring->head = i == 1 ? random() : ring->head - random() % 10;
      const std::size_t got = reader.read(out);
      ASSERT_LE(got, out.size());
      n += got;
    }
  }
  EXPECT_GT(n, 0u);
}

TEST_F(TapRings, AReaderWhoseWriterCountsBackReadsTheNextRecord) {
  Tap tap(*ring);
  for (std::uint64_t i = 0; i < 9; ++i) tap.append(numbered_record(i));
  TapReader reader(*ring);
  ring->head = 3;
  TapRecord out[4];
  EXPECT_EQ(reader.read(out), 0u);
  ring->head = 4;
  ASSERT_EQ(reader.read(out), 1u);
  EXPECT_EQ(out[0].at, Nanoseconds{3});
}

struct Seen {
  std::uint64_t read = 0, torn = 0, backwards = 0, position = 0, lost = 0;
};

// Reads until the writer is done and nothing is left; `pause` between reads lets the writer get a ring ahead.
Seen follow(const TapRing& ring, const std::atomic<bool>& done, std::chrono::milliseconds pause) {
  TapReader reader(ring, true);
  std::vector<TapRecord> out(512);
  Seen seen;
  std::int64_t last = -1;
  for (bool last_round = false;;) {
    const std::size_t n = reader.read(out);
    for (std::size_t i = 0; i < n; ++i) {
      seen.torn += is_whole(out[i]) ? 0 : 1;
      seen.backwards += out[i].at.count > last ? 0 : 1;
      last = out[i].at.count;
    }
    seen.read += n;
    if (n == 0 && last_round) break;
    if (n == 0) last_round = done.load(std::memory_order_acquire);
    if (pause.count() > 0) std::this_thread::sleep_for(pause);
  }
  seen.position = reader.position();
  seen.lost = reader.lost();
  return seen;
}

TEST_F(TapRings, NoRecordOfAMillionIsTornAndEveryGapIsCounted) {
  constexpr std::uint64_t kMillion = 1'000'000;
  std::atomic<bool> done{false};
  std::atomic<int> ready{0};
  std::array<Seen, 2> seen;
  std::vector<std::thread> readers;
  for (int i = 0; i < 2; ++i) {
    readers.emplace_back([&, i] {
      ++ready;
      seen[static_cast<std::size_t>(i)] = follow(*ring, done, std::chrono::milliseconds(i * 10));
    });
  }
  while (ready.load() != 2) std::this_thread::yield();
  Tap tap(*ring);
  for (std::uint64_t i = 0; i < kMillion; ++i) tap.append(numbered_record(i));
  done.store(true, std::memory_order_release);
  for (auto& reader : readers) reader.join();
  for (const Seen& s : seen) {
    EXPECT_EQ(s.torn, 0u);
    EXPECT_EQ(s.backwards, 0u);
    EXPECT_GT(s.read, 0u);
    EXPECT_EQ(s.read + s.lost, s.position);
    EXPECT_EQ(s.position, kMillion);
  }
  EXPECT_GT(seen[1].lost, 0u);  // the slow one was overtaken
}

}  // namespace
}  // namespace chimera
