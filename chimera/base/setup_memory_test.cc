// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/setup_memory.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>

namespace chimera {
namespace {

struct alignas(64) Line {
  int number = 7;
};

struct GivenMemoryTest : ::testing::Test {
  GivenMemoryTest() { bytes.fill(std::byte{0xff}); }
  alignas(64) std::array<std::byte, 256> bytes;
  GivenMemory memory{bytes};
};

TEST_F(GivenMemoryTest, GivesOnePieceBehindTheOtherEachAligned) {
  const auto first = memory.take_bytes(3, 1);
  const auto numbers = memory.take<std::uint32_t>(2);
  const auto lines = memory.take<Line>(2);
  EXPECT_EQ(first.data(), bytes.data());
  EXPECT_EQ(reinterpret_cast<std::byte*>(numbers.data()), bytes.data() + 4);
  EXPECT_EQ(reinterpret_cast<std::byte*>(lines.data()), bytes.data() + 64);
  EXPECT_EQ(lines[1].number, 7) << "as the type makes it";
  EXPECT_EQ(numbers[1], 0u);
  EXPECT_EQ(first[2], std::byte{0});
  EXPECT_EQ(memory.used(), 192u);
}

TEST_F(GivenMemoryTest, GivesItsLastByteAndNoMore) {
  EXPECT_EQ(memory.take_bytes(256, 1).size(), 256u);
  EXPECT_EQ(memory.take<Line>(0).size(), 0u);
  EXPECT_DEATH((void)memory.take_bytes(1, 1), "fits");
}

TEST_F(GivenMemoryTest, TellsThatItIsTooSmall) {
  const auto tell = [](std::size_t given) {
    std::fprintf(stderr, "%zu bytes are too few\n", given);
    std::_Exit(3);
  };
  GivenMemory told(bytes, tell);
  EXPECT_EQ(told.take_bytes(256, 1).size(), 256u);
  EXPECT_EXIT((void)told.take_bytes(1, 1), ::testing::ExitedWithCode(3), "256 bytes are too few");
}

}  // namespace
}  // namespace chimera
