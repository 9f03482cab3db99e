// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/takeover.h"

#include <gtest/gtest.h>

#include <cstring>

namespace chimera {
namespace {

Takeover takeover(std::uint32_t number, Nanoseconds ended) {
  Takeover one;
  one.number = number;
  one.lost = milliseconds(number);
  one.ended = ended;
  return one;
}

TEST(TakeoverRing, GivesOutTakeoversThatAreOverOrOfADeadContext) {
  TakeoverRing ring;
  Takeover read;
  EXPECT_FALSE(ring.read(1, false, read)) << "it has not begun";
  ring.put(takeover(1, kNever));
  EXPECT_FALSE(ring.read(1, true, read));
  ASSERT_TRUE(ring.read(1, false, read));
  EXPECT_EQ(read.ended, kNever);
  ring.put(takeover(1, seconds(1)));
  ASSERT_TRUE(ring.read(1, true, read));
  EXPECT_EQ(read.ended, seconds(1));
  EXPECT_FALSE(ring.read(2, false, read));
}

constexpr std::uint32_t kKept = TakeoverRing::kKept;

TEST(TakeoverRing, KeepsTheLast) {
  TakeoverRing ring;
  for (std::uint32_t n = 1; n <= kKept + 12; ++n) ring.put(takeover(n, seconds(1)));
  EXPECT_EQ(ring.oldest(), 13u);
  Takeover read;
  EXPECT_FALSE(ring.read(12, true, read));
  for (std::uint32_t n = 13; n <= kKept + 12; ++n) {
    ASSERT_TRUE(ring.read(n, true, read));
    EXPECT_EQ(read.number, n);
    EXPECT_EQ(read.lost, milliseconds(n));
  }
}

TEST(TakeoverRing, TwoAtATimeMayBeOverInEitherOrder) {
  TakeoverRing ring;
  for (const std::uint32_t n : {1u, 2u}) ring.put(takeover(n, kNever));
  for (const std::uint32_t n : {2u, 1u}) ring.put(takeover(n, seconds(1)));
  Takeover read;
  for (const std::uint32_t n : {1u, 2u}) EXPECT_TRUE(ring.read(n, true, read)) << n;
}

TEST(TakeoverRing, ADeathInAWriteKeepsTheOlderTakeovers) {
  TakeoverRing ring;
  for (std::uint32_t n = 1; n <= kKept + 1; ++n) ring.put(takeover(n, seconds(1)));
  const std::uint32_t oldest = ring.oldest();
  std::uint32_t last;  // the first word, which is stored last
  std::memcpy(&last, static_cast<const void*>(&ring), sizeof last);
  ASSERT_EQ(last, kKept + 1);
  ring.put(takeover(kKept + 2, seconds(1)));
  std::memcpy(static_cast<void*>(&ring), &last, sizeof last);
  Takeover read;
  for (std::uint32_t n = oldest; n <= kKept + 1; ++n) EXPECT_TRUE(ring.read(n, false, read)) << n;
}

// A takeover that was overwritten cannot be stored again: its place belongs to a younger one.
TEST(TakeoverRing, AnOverwrittenTakeoverKeepsTheYoungerOnes) {
  TakeoverRing ring;
  for (std::uint32_t n = 1; n <= kKept + 2; ++n) ring.put(takeover(n, n == 1 ? kNever : seconds(1)));
  ring.put(takeover(1, seconds(1)));
  Takeover read;
  EXPECT_FALSE(ring.read(1, true, read));
  for (std::uint32_t n = 3; n <= kKept + 2; ++n) EXPECT_TRUE(ring.read(n, true, read)) << n;
}

TEST(TakeoverRing, AnOpenOneBetweenOthersIsWaitedFor) {
  TakeoverRing ring;
  ring.put(takeover(1, kNever));
  ring.put(takeover(2, seconds(1)));
  Takeover read;
  EXPECT_FALSE(ring.read(1, true, read));
  EXPECT_TRUE(ring.read(2, true, read));
}

}  // namespace
}  // namespace chimera
