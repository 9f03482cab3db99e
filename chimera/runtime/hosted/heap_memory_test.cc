// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/heap_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>

namespace chimera {
namespace {

struct alignas(64) Line {
  int number = 7;
};

TEST(HeapMemory, GivesAlignedValuesAsTheirTypeMakesThem) {
  HeapMemory memory;
  const auto lines = memory.take<Line>(3);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(lines.data()) % 64, 0u);
  EXPECT_EQ(lines[2].number, 7);
  EXPECT_TRUE(memory.take<Line>(0).empty());
}

TEST(HeapMemory, GivesZeroedBytesThatStayWhereTheyAre) {
  HeapMemory memory;
  const auto first = memory.take_bytes(100, 8);
  EXPECT_EQ(std::count(first.begin(), first.end(), std::byte{}), 100);
  first[99] = std::byte{5};
  for (int i = 0; i < 1000; ++i) (void)memory.take_bytes(10, 1);
  EXPECT_EQ(first[99], std::byte{5});
}

TEST(HeapMemory, KeptBytesOutliveTheMemory) {
  std::optional<HeapMemory> memory(std::in_place);
  const auto kept = memory->take_bytes(16, 8);
  memory->keep_for_ever();
  memory.reset();
  kept[0] = std::byte{5};  // else a use after free, which the sanitizer reports
  EXPECT_EQ(kept[0], std::byte{5});
}

}  // namespace
}  // namespace chimera
