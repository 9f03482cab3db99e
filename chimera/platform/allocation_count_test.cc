// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/allocation_count.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>

namespace chimera {
namespace {

TEST(AllocationCount, SeesEveryWayToAllocate) {
  watch_allocations();
  const std::uint64_t before = allocations_of_this_thread();
  const std::int64_t live = live_allocations();
  void* volatile block = std::malloc(10);
  EXPECT_EQ(allocations_of_this_thread(), before + 1);
  EXPECT_EQ(live_allocations(), live + 1);
  block = std::realloc(block, 1000);
  std::free(block);
  EXPECT_EQ(live_allocations(), live);
  const auto number = std::make_unique<int>(3);
  EXPECT_EQ(*number, 3);
  void* aligned = nullptr;
  EXPECT_EQ(::posix_memalign(&aligned, 256, 512), 0);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(aligned) % 256, 0u);
  EXPECT_EQ(live_allocations(), live + 2);
  std::free(aligned);
  EXPECT_GE(allocations_of_this_thread(), before + 4);
}

TEST(AllocationCount, KeepsThreadsApart) {
  watch_allocations();
  std::uint64_t there = 0;
  std::thread other([&there] {
    const std::uint64_t before = allocations_of_this_thread();
    void* volatile block = std::malloc(1);
    std::free(block);
    there = allocations_of_this_thread() - before;
  });
  other.join();
  EXPECT_EQ(there, 1u);
}

}  // namespace
}  // namespace chimera
