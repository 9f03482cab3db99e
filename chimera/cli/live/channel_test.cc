// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/channel.h"
#include "chimera/text/json.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chimera::cli {
namespace {

std::string parts(const Json& value, const std::string& part = "") {
  std::string text;
  for (const ChannelNumber& number : numbers_of(value, part)) {
    text += number.part + "=" + (std::isnan(number.value) ? "nan" : Json(number.value).dump()) + " ";
  }
  return text;
}

TEST(Channel, AVariableIsAllOfItsNumbers) {
  EXPECT_EQ(parts(1.5), "=1.5 ");
  EXPECT_EQ(parts(true), "=1.0 ");
  EXPECT_EQ(parts({1, nullptr}), "[0]=1.0 [1]=nan ");
  EXPECT_EQ(parts({{"x", 1}, {"name", "left"}, {"y", {2, 3}}}), ".x=1.0 .y[0]=2.0 .y[1]=3.0 ");
  EXPECT_EQ(parts("text"), "");
}

TEST(Channel, APartIsAnElementOrAField) {
  EXPECT_EQ(parts({1, 2, 3}, "[1]"), "[1]=2.0 ");
  EXPECT_EQ(parts({1, 2, 3}, "[3]"), "");
  EXPECT_EQ(parts({{"x", {7, 8}}}, ".x[1]"), ".x[1]=8.0 ");
  EXPECT_EQ(parts({{"x", {7, 8}}}, ".x"), ".x[0]=7.0 .x[1]=8.0 ");
  EXPECT_EQ(parts(1, ".x"), "");
}

TEST(Channel, NamesAreReadToTheirEnd) {
  const auto channel = read_channel("pose.p[2]");
  ASSERT_TRUE(channel);
  EXPECT_EQ(channel->variable, "pose");
  EXPECT_EQ(channel->part, ".p[2]");
  for (const char* wrong : {"", "[1]", "q[", "q[]", "q[-1]", "q[1", "q.", "q x", "q[99999999999999999999]"}) {
    const auto refused = read_channel(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(std::string(refused.error().message.view()),
              "'" + std::string(wrong) + "' is not the name of a variable; expected a name such as q, q[2] or pose.x");
  }
}

}  // namespace
}  // namespace chimera::cli
