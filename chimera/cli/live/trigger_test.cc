// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/trigger.h"

#include <gtest/gtest.h>

#include <cmath>

#include "chimera/units/testing/unit_samples.h"

namespace chimera::cli {
namespace {

Trigger settled(const std::string& text, const std::string& unit) {
  auto trigger = Trigger::read(text, our_units());
  EXPECT_TRUE(trigger) << text;
  EXPECT_TRUE(trigger->settle(unit, our_units())) << text;
  return *trigger;
}

std::string refusal(const std::string& text, const std::string& unit = "rad") {
  auto trigger = Trigger::read(text, our_units());
  if (!trigger) return std::string(trigger.error().message.view());
  const auto level = trigger->settle(unit, our_units());
  return level ? "none" : std::string(level.error().message.view());
}

/// Firings of the trigger, as a text of 0 and 1.
std::string edges(Trigger trigger, std::initializer_list<double> values) {
  std::string word;
  for (const double value : values) word += trigger.fires(value) ? '1' : '0';
  return word;
}

TEST(Trigger, TheLevelIsConvertedToTheUnitOfTheVariable) {
  EXPECT_DOUBLE_EQ(settled("error > 2 mrad", "rad").level(), 0.002);
  EXPECT_DOUBLE_EQ(settled("q[2]>=180 deg", "rad").level(), 3.14159265358979323846);
  EXPECT_EQ(settled("  |q[2]| >= 1 rad", "rad").channel().part, "[2]");
  EXPECT_EQ(settled("mode == 3", "1").level(), 3);
}

TEST(Trigger, FiresAtTheEdgeOnly) {
  EXPECT_EQ(edges(settled("e > 1", "1"), {0, 1, 2, 3, 0, 2}), "001001");
  EXPECT_EQ(edges(settled("e > 1", "1"), {2, 3, 0, 2}), "0001") << "a comparison that is true at first is no edge";
  EXPECT_EQ(edges(settled("e <= -1", "1"), {0, -1, -2}), "010");
  EXPECT_EQ(edges(settled("|e| > 1", "1"), {0, -2, 2}), "010");
  EXPECT_EQ(edges(settled("e != 0", "1"), {0, 1, 2}), "010");
  EXPECT_EQ(edges(settled("ready == true", "1"), {0, 1, 1}), "010");
}

TEST(Trigger, NotANumberHoldsNoComparison) {
  EXPECT_EQ(edges(settled("e != 0", "1"), {0, NAN, 1}), "001");
  EXPECT_EQ(edges(settled("e > 1", "1"), {NAN, 2}), "01");
}

TEST(Trigger, RefusesWithTheReason) {
  EXPECT_EQ(refusal("error"), "trigger 'error': expected VARIABLE, one of > >= < <= == !=, QUANTITY");
  EXPECT_EQ(refusal("> 2 rad"),
            "trigger '> 2 rad': '' is not the name of a variable; expected a name such as q, q[2] or pose.x");
  EXPECT_EQ(refusal("error > 2 kg").rfind("trigger 'error > 2 kg': ", 0), 0u) << refusal("error > 2 kg");
  EXPECT_EQ(refusal("error > 2").rfind("trigger 'error > 2': ", 0), 0u) << refusal("error > 2");
  EXPECT_EQ(refusal("error > 2 mradd").rfind("trigger 'error > 2 mradd': ", 0), 0u);
}

}  // namespace
}  // namespace chimera::cli
