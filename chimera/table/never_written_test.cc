// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/never_written.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace chimera {
namespace {

template <class T>
std::array<T, 3> filled(NeverWritten kind) {
  std::array<T, 3> values;
  values.fill(T{1});
  fill_never_written(std::as_writable_bytes(std::span(values)), kind);
  return values;
}

TEST(NeverWritten, FloatsAreNan) {
  for (const float x : filled<float>(NeverWritten::kFloat32)) EXPECT_TRUE(std::isnan(x));
  for (const double x : filled<double>(NeverWritten::kFloat64)) EXPECT_TRUE(std::isnan(x));
}

TEST(NeverWritten, OtherTypesAreZero) {
  EXPECT_EQ(filled<std::int32_t>(NeverWritten::kZero), (std::array<std::int32_t, 3>{}));
}

TEST(NeverWritten, StaysInsideItsBytes) {
  std::array<std::byte, 20> bytes;
  bytes.fill(std::byte{0x11});
  fill_never_written(std::span(bytes).first(12), NeverWritten::kFloat64);
  EXPECT_EQ(bytes[8], std::byte{0});
  EXPECT_EQ(bytes[11], std::byte{0});
  EXPECT_EQ(bytes[12], std::byte{0x11});
}

}  // namespace
}  // namespace chimera
