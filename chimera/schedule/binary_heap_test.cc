// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/binary_heap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace chimera {
namespace {

struct BinaryHeapTest : ::testing::Test {
  static bool before(int a, int b) { return a < b; }
  std::vector<int> drained() {
    std::vector<int> all;
    for (; !heap.is_empty(); heap.erase(0, before)) all.push_back(heap.top());
    return all;
  }
  std::array<int, 100> memory{};
  BinaryHeap<int> heap{memory};
};

TEST_F(BinaryHeapTest, GivesBackInOrder) {
  for (const int item : {5, 1, 4, 1, 3}) heap.push(item, before);
  EXPECT_EQ(heap.size(), 5u);
  EXPECT_EQ(drained(), (std::vector{1, 1, 3, 4, 5}));
}

TEST_F(BinaryHeapTest, IsOneItemOrNone) {
  heap.push(3, before);
  heap.push(2, before);
  heap.set_only(7);
  EXPECT_EQ(drained(), std::vector{7});
  heap.push(1, before);
  heap.clear();
  EXPECT_TRUE(heap.is_empty());
}

TEST_F(BinaryHeapTest, AgreesWithASortedListOnRandomSteps) {
  std::mt19937 random(1);
  std::vector<int> plain;
  for (int step = 0; step < 20'000; ++step) {
    if (plain.empty() || (plain.size() < memory.size() && random() % 2 == 0)) {
      plain.push_back(static_cast<int>(random() % 50));
      heap.push(plain.back(), before);
    } else {
      const auto at = static_cast<std::uint32_t>(random() % plain.size());
      plain.erase(std::find(plain.begin(), plain.end(), heap.items()[at]));
      heap.erase(at, before);
    }
    ASSERT_EQ(heap.size(), plain.size());
    if (!plain.empty()) { ASSERT_EQ(heap.top(), *std::min_element(plain.begin(), plain.end())); }
  }
}

TEST_F(BinaryHeapTest, PutsATopThatCameToBeLaterWhereItBelongs) {
  std::array<int, 3> keys{1, 2, 3};
  const auto key = [&keys](int item) { return keys[static_cast<std::size_t>(item)]; };
  const auto by_key = [&key](int a, int b) { return key(a) < key(b); };
  for (const int item : {0, 1, 2}) heap.push(item, by_key);
  keys[0] = 4;
  heap.sift_top(by_key);
  EXPECT_EQ(heap.top(), 1);
  heap.erase(0, by_key);
  EXPECT_EQ(heap.top(), 2);
}

}  // namespace
}  // namespace chimera
