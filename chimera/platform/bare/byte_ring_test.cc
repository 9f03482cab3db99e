// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/bare/byte_ring.h"

#include <gtest/gtest.h>

#include <thread>

namespace chimera::bare::byte_ring_test {

TEST(ByteRing, GivesBytesInTheirOrderAlsoBeyondItsEnd) {
  ByteRing<4> ring;
  for (int i = 0; i < 100; i += 3) {
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(ring.add(static_cast<std::uint8_t>(i + k)));
    for (int k = 0; k < 3; ++k) ASSERT_EQ(ring.take(), i + k);
  }
  EXPECT_EQ(ring.take(), -1);
}

TEST(ByteRing, RefusesAByteIfFull) {
  ByteRing<4> ring;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.add(7));
  EXPECT_EQ(ring.free(), 0u);
  EXPECT_FALSE(ring.add(8));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(ring.take(), 7);
}

TEST(ByteRing, CarriesBytesBetweenTwoThreads) {
  ByteRing<8> ring;
  constexpr int kBytes = 20'000;
  std::jthread writer([&ring] {
    for (int i = 0; i < kBytes; ++i)
      while (!ring.add(static_cast<std::uint8_t>(i))) std::this_thread::yield();
  });
  int n_wrong = 0;
  for (int i = 0; i < kBytes; ++i) {
    int byte = ring.take();
    for (; byte < 0; byte = ring.take()) std::this_thread::yield();
    n_wrong += byte != i % 256 ? 1 : 0;
  }
  EXPECT_EQ(n_wrong, 0);
}

}  // namespace chimera::bare::byte_ring_test
