// SPDX-License-Identifier: Apache-2.0
#include "chimera/catalogue/descriptor_value.h"

#include <gtest/gtest.h>

#include <array>

#include "chimera/task/abi.h"

namespace chimera {
namespace {

template <class V>
void expect_round_trip(std::uint32_t type, std::size_t size, V value) {
  std::array<std::byte, 16> memory{};
  const std::span<std::byte> at(memory.data(), size);
  ASSERT_TRUE(store_plain(type, PlainValue(value), at));
  EXPECT_EQ(load_plain(type, at), PlainValue(value));
}

TEST(DescriptorValue, ComesBackAsItWas) {
  expect_round_trip(CHIMERA_BOOL, 1, true);
  expect_round_trip(CHIMERA_INT32, 4, std::int64_t{INT32_MIN});
  expect_round_trip(CHIMERA_INT64, 8, std::int64_t{INT64_MAX});
  expect_round_trip(CHIMERA_FLOAT32, 4, 0.5);
  expect_round_trip(CHIMERA_FLOAT64, 8, 0.1);
  expect_round_trip(CHIMERA_STRING, 8, std::string("seven b"));
}

TEST(DescriptorValue, RefusesAValueThatDoesNotFit) {
  std::array<std::byte, 8> memory{};
  EXPECT_FALSE(store_plain(CHIMERA_BOOL, PlainValue(std::int64_t{1}), std::span(memory).first(1)));
  EXPECT_FALSE(store_plain(CHIMERA_INT32, PlainValue(std::int64_t{1} << 31), std::span(memory).first(4)));
  EXPECT_FALSE(store_plain(CHIMERA_INT32, PlainValue(1.5), std::span(memory).first(4)));
  EXPECT_FALSE(store_plain(CHIMERA_INT64, PlainValue(1.0), memory));
  EXPECT_FALSE(store_plain(CHIMERA_FLOAT64, PlainValue(std::string("1")), memory));
  EXPECT_FALSE(store_plain(CHIMERA_STRING, PlainValue(std::string("eight by")), memory));
  EXPECT_FALSE(store_plain(CHIMERA_STRING, PlainValue(std::string("a\0b", 3)), memory));
}

TEST(DescriptorValue, AWholeNumberFitsAFloat) {
  std::array<std::byte, 8> memory{};
  ASSERT_TRUE(store_plain(CHIMERA_FLOAT64, PlainValue(std::int64_t{3}), memory));
  EXPECT_EQ(load_plain(CHIMERA_FLOAT64, memory), PlainValue(3.0));
}

}  // namespace
}  // namespace chimera
