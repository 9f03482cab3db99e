// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/section.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace chimera {
namespace {

TEST(Section, ExcludesAndCountsWhoFoundItTaken) {
  Section section;
  std::uint64_t sum = 0;  // not atomic: the section is what protects it
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 20'000; ++i) {
        section.enter();
        ++sum;
        section.leave();
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(sum, 80'000u);
  const std::uint64_t before = section.times_taken();
  section.enter();
  section.leave();
  EXPECT_EQ(section.times_taken(), before);
}

}  // namespace
}  // namespace chimera
