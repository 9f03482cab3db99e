// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/tap.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

namespace chimera {
namespace {

TapRecord numbered(std::int64_t number) {
  TapRecord record;
  record.at = Nanoseconds{number};
  record.b = -number;
  record.a = static_cast<std::uint32_t>(number);
  return record;
}

TEST(Tap, GivesBackWhatWasAppendedInOrder) {
  std::array<TapRecord, 8> ring;
  Tap tap(ring);
  for (int i = 0; i < 5; ++i) tap.append(numbered(i));
  std::array<TapRecord, 3> out;
  ASSERT_EQ(tap.read(out), 3u);
  EXPECT_EQ(out[2].at, Nanoseconds{2});
  ASSERT_EQ(tap.read(out), 2u);
  EXPECT_EQ(out[1].at, Nanoseconds{4});
  EXPECT_EQ(tap.read(out), 0u);
}

TEST(Tap, DropsAndCountsWhatDoesNotFitAndKeepsTheBeginning) {
  std::array<TapRecord, 4> ring;
  Tap tap(ring);
  for (int i = 0; i < 7; ++i) tap.append(numbered(i));
  EXPECT_EQ(tap.dropped(), 3u);
  std::array<TapRecord, 8> out;
  ASSERT_EQ(tap.read(out), 4u);
  EXPECT_EQ(out[3].at, Nanoseconds{3});
  tap.append(numbered(9));
  ASSERT_EQ(tap.read(out), 1u);
  EXPECT_EQ(out[0].at, Nanoseconds{9});
}

TEST(Tap, LosesNothingItDidNotCountAndTearsNothingBesideAReader) {
  constexpr std::int64_t kRecords = 200'000;
  std::vector<TapRecord> ring(64);
  Tap tap(ring);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::int64_t i = 0; i < kRecords; ++i) {
      tap.append(numbered(i));
      if (i % 16 == 0) std::this_thread::yield();
    }
    done.store(true, std::memory_order_release);
  });
  std::array<TapRecord, 16> out;
  std::int64_t last = -1, n_read = 0;
  for (bool last_round = false;;) {
    const std::size_t n = tap.read(out);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_GT(out[i].at.count, last);
      ASSERT_EQ(out[i].b, -out[i].at.count);
      ASSERT_EQ(out[i].a, static_cast<std::uint32_t>(out[i].at.count));
      last = out[i].at.count;
    }
    n_read += static_cast<std::int64_t>(n);
    if (n == 0 && last_round) break;
    last_round = done.load(std::memory_order_acquire);
  }
  writer.join();
  EXPECT_EQ(n_read + static_cast<std::int64_t>(tap.dropped()), kRecords);
  EXPECT_GT(n_read, 0);
}

}  // namespace
}  // namespace chimera
