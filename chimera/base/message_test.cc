// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/message.h"

#include <gtest/gtest.h>

#include <string>

namespace chimera {
namespace {

TEST(Message, WritesTextAndNumbers) {
  Message m;
  m << "a" << 0 << " " << -17 << " " << std::uint32_t{42} << " " << INT64_MIN << " " << UINT64_MAX;
  EXPECT_EQ(m.view(), "a0 -17 42 -9223372036854775808 18446744073709551615");
}

TEST(Message, IsCutAtItsCapacity) {
  Message m;
  m << std::string(399, 'x') << 123;
  EXPECT_EQ(m.view(), std::string(399, 'x') + "1");
}

TEST(Message, BecomesAnError) {
  const Error e = (Message() << "found " << 3).error(ErrorCode::kRefused, "here");
  EXPECT_EQ(e.code, ErrorCode::kRefused);
  EXPECT_EQ(e.message.view(), "found 3");
  EXPECT_EQ(e.where.view(), "here");
}

}  // namespace
}  // namespace chimera
