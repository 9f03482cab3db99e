// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/number_at.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

template <class T>
double read(std::uint32_t type, T value) {
  std::byte bytes[1 + sizeof value];
  std::memcpy(bytes + 1, &value, sizeof value);
  return number_at(type, bytes + 1);  // an odd address, so unaligned for every type
}

TEST(NumberAt, ReadsEveryTypeOfNumber) {
  EXPECT_EQ(read(CHIMERA_BOOL, true), 1);
  EXPECT_EQ(read(CHIMERA_INT32, std::int32_t{-7}), -7);
  EXPECT_EQ(read(CHIMERA_INT64, std::int64_t{1} << 53), 9007199254740992.0);
  EXPECT_EQ(read(CHIMERA_FLOAT32, 0.5f), 0.5);
  EXPECT_EQ(read(CHIMERA_FLOAT64, -1e300), -1e300);
}

TEST(NumberAt, AValueThatIsNoNumberIsZero) {
  EXPECT_EQ(read(CHIMERA_STRING, std::int64_t{0x33323130}), 0);
  EXPECT_EQ(read(CHIMERA_STRUCT, 1.0), 0);
}

}  // namespace
}  // namespace chimera
