// SPDX-License-Identifier: Apache-2.0
#include "library/signals/row_ring.h"

#include <gtest/gtest.h>

#include <thread>

namespace chimera::library {
namespace {

TEST(RowRing, HandsRowsOnInOrderAndRefusesWhenFull) {
  RowRing ring;
  ring.make(2, 3);
  EXPECT_EQ(ring.front(), nullptr);
  for (int i = 0; i < 3; ++i) {
    double* row = ring.begin();
    ASSERT_NE(row, nullptr);
    row[0] = i, row[1] = -i;
    ring.commit();
  }
  EXPECT_EQ(ring.begin(), nullptr);
  for (int i = 0; i < 3; ++i) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(ring.front()[0], i);
    EXPECT_EQ(ring.front()[1], -i);
    ring.release();
  }
  EXPECT_EQ(ring.front(), nullptr);
  EXPECT_NE(ring.begin(), nullptr);
}

TEST(RowRing, LosesAndTearsNothingBetweenTwoThreads) {
  RowRing ring;
  ring.make(2, 8);
  constexpr int kRows = 100'000;
  int wrong = 0, taken = 0;
  std::thread reader([&] {
    while (taken < kRows) {
      const double* row = ring.front();
      if (row == nullptr) {
        std::this_thread::yield();
        continue;
      }
      if (row[0] != taken || row[1] != 2 * taken) ++wrong;
      ring.release();
      ++taken;
    }
  });
  for (int i = 0; i < kRows;) {
    double* row = ring.begin();
    if (row == nullptr) {
      std::this_thread::yield();
      continue;
    }
    row[0] = i, row[1] = 2 * i;
    ring.commit();
    ++i;
  }
  reader.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace chimera::library
