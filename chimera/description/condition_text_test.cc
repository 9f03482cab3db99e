// SPDX-License-Identifier: Apache-2.0
#include "chimera/description/condition_text.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

Node scalar(std::string text) {
  Node node;
  node.kind = Node::Kind::kScalar;
  node.at = {3, 7};
  node.text = std::move(text);
  return node;
}

/// "speed < 0.1 rad/s" in pieces, "speed|-|<|0.1 rad/s"; otherwise the text of the fault.
std::string read(const std::string& text) {
  Report report("demo.yaml");
  const auto condition = read_condition(scalar(text), "'safe_when'", report);
  if (!condition) return report.faults()[0].message;
  EXPECT_TRUE(report.is_legal());
  EXPECT_EQ(condition->value.at, (Place{3, 7}));
  return condition->variable.text + "|" + (condition->element ? std::to_string(*condition->element) : "-") + "|" +
         sign_of(condition->comparison) + "|" + condition->value.text;
}

TEST(ConditionText, IsCutIntoItsParts) {
  EXPECT_EQ(read("speed < 0.1 rad/s"), "speed|-|<|0.1 rad/s");
  EXPECT_EQ(read("  speed<=-3 "), "speed|-|<=|-3");
  EXPECT_EQ(read("q[2] >= 1e-3rad"), "q|2|>=|1e-3rad");
  EXPECT_EQ(read("q [ 0 ] > 0"), "q|0|>|0");
  EXPECT_EQ(read("closed == true"), "closed|-|==|true");
  EXPECT_EQ(read("mode != 3"), "mode|-|!=|3");
}

TEST(ConditionText, NamesTheError) {
  EXPECT_EQ(read("speed"), "'safe_when' is 'speed', which compares nothing");
  EXPECT_EQ(read("speed = 3"), "'safe_when' is 'speed = 3', which compares nothing");
  EXPECT_EQ(read("speed ! 3"), "'safe_when' is 'speed ! 3', which compares nothing");
  EXPECT_EQ(read("speed <"), "'safe_when' is 'speed <': there is no value");
  EXPECT_EQ(read("q[] < 3"), "'safe_when' is 'q[] < 3': no number in brackets");
  EXPECT_EQ(read("q[-1] < 3"), "'safe_when' is 'q[-1] < 3': no number in brackets");
  EXPECT_EQ(read("q[4294967296] < 3"), "'safe_when' is 'q[4294967296] < 3': no number in brackets");
  EXPECT_EQ(read("q] < 3"), "'safe_when' is 'q] < 3': no number in brackets");
  EXPECT_EQ(read("< 3"),
            "the variable of 'safe_when' is ''; expected a letter or '_', then letters, digits and '_', at most 64");
}

TEST(ConditionText, IsAText) {
  Report report("demo.yaml");
  Node list;
  list.kind = Node::Kind::kList;
  EXPECT_FALSE(read_condition(list, "'safe_when'", report));
  EXPECT_EQ(report.faults()[0].message, "'safe_when' is a list; expected a comparison, as 'speed < 0.1 rad/s'");
}

}  // namespace
}  // namespace chimera
