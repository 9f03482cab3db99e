// SPDX-License-Identifier: Apache-2.0
#include "library/device/latest.h"

#include <gtest/gtest.h>

#include <thread>

namespace chimera::library {
namespace {

TEST(Latest, IsTheValueThatWasPutLast) {
  Latest<int> latest;
  EXPECT_EQ(latest.get(), 0);
  latest.put(1);
  latest.put(2);
  EXPECT_EQ(latest.get(), 2);
  EXPECT_EQ(latest.get(), 2);
  for (int i = 3; i < 20; ++i) {
    latest.put(i);
    ASSERT_EQ(latest.get(), i);
  }
}

struct Pair {
  std::uint64_t first = 0, words[6] = {}, last = 0;
};

TEST(Latest, IsNeverHalfOldAndNeverGoesBack) {
  constexpr std::uint64_t kValues = 200'000;
  Latest<Pair> latest;
  std::thread writer([&latest] {
    for (std::uint64_t i = 1; i <= kValues; ++i) latest.put({i, {i, i, i, i, i, i}, i});
  });
  std::uint64_t before = 0;
  bool is_sound = true;
  while (before < kValues && is_sound) {
    const Pair& pair = latest.get();
    is_sound = pair.first == pair.last && pair.words[3] == pair.first && pair.first >= before;
    before = pair.first;
  }
  writer.join();
  EXPECT_TRUE(is_sound) << before;
}

}  // namespace
}  // namespace chimera::library
