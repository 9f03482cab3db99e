// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/switch/switch_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace chimera::value_step_test {
namespace {

template <class T>
std::span<const std::byte> bytes(const std::vector<T>& values) {
  return std::as_bytes(std::span<const T>(values));
}

template <class T>
ValueStep step(std::uint32_t type, const std::vector<T>& before, const std::vector<T>& after,
               const std::vector<T>& limits = {}) {
  PortSpec port;
  port.type = type;
  port.element_bytes = sizeof(T);
  port.extent[0].max = static_cast<std::uint32_t>(before.size());
  port.max_step = bytes(limits);
  const chimera_port_decl declared{};
  return step_between(port, declared, port.max_count(), bytes(before).data(), bytes(after).data());
}

TEST(ValueStep, WithoutALimitTheLargestDifferenceCounts) {
  const ValueStep found = step<double>(CHIMERA_FLOAT64, {1, 2, 3}, {1.5, 0, 3});
  EXPECT_TRUE(found.is_known);
  EXPECT_EQ(found.size, 2);
  EXPECT_EQ(found.limit, 0);
  EXPECT_FALSE(found.is_beyond);
}

TEST(ValueStep, TheElementNearestToItsLimitCounts) {
  const ValueStep near = step<double>(CHIMERA_FLOAT64, {0, 0}, {5, 1}, {10, 1.5});
  EXPECT_EQ(near.size, 1);
  EXPECT_EQ(near.limit, 1.5);
  EXPECT_FALSE(near.is_beyond);
  EXPECT_FALSE(step<double>(CHIMERA_FLOAT64, {0}, {1}, {1}).is_beyond);  // as far as the limit is allowed
  EXPECT_TRUE(step<double>(CHIMERA_FLOAT64, {0, 0}, {11, 0}, {10, 1}).is_beyond);
}

TEST(ValueStep, EveryTypeOfNumberIsMeasured) {
  EXPECT_EQ(step<float>(CHIMERA_FLOAT32, {1.0f}, {1.5f}).size, 0.5);
  EXPECT_EQ(step<std::int32_t>(CHIMERA_INT32, {-3}, {4}).size, 7);
  EXPECT_EQ(step<std::int64_t>(CHIMERA_INT64, {5}, {2}, {2}).is_beyond, true);
  EXPECT_EQ(step<std::uint8_t>(CHIMERA_BOOL, {0}, {1}).size, 1);
  EXPECT_FALSE(step<char>(CHIMERA_STRING, {'a'}, {'b'}).is_known);
}

TEST(ValueStep, NotANumberIsBeyondEveryLimit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ValueStep found = step<double>(CHIMERA_FLOAT64, {0, 0, 0}, {9, nan, 1}, {10, 10, 10});
  EXPECT_TRUE(found.is_beyond);
  EXPECT_TRUE(std::isnan(found.size));
  EXPECT_FALSE(step<double>(CHIMERA_FLOAT64, {0}, {nan}).is_beyond);  // the port has no limit
}

TEST(ValueStep, EveryFieldOfAStructIsMeasured) {
  struct Pair {
    std::int32_t n;
    float x[2];
  };
  const chimera_field fields[] = {{"n", "1", CHIMERA_INT32, offsetof(Pair, n), 1, 4},
                                  {"x", "1", CHIMERA_FLOAT32, offsetof(Pair, x), 2, 4}};
  chimera_port_decl declared{};
  declared.fields = fields;
  declared.n_fields = 2;
  PortSpec port;
  port.type = CHIMERA_STRUCT;
  port.element_bytes = sizeof(Pair);
  const Pair before{1, {0, 0}}, after{2, {0, 2.5f}};
  const auto of = [](const Pair& pair) { return std::as_bytes(std::span(&pair, 1)).data(); };
  EXPECT_EQ(step_between(port, declared, 1, of(before), of(after)).size, 2.5);
}

}  // namespace
}  // namespace chimera::value_step_test
