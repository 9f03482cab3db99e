// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/operator_text.h"

#include <gtest/gtest.h>

#include "chimera/units/testing/unit_samples.h"

namespace chimera::cli {
namespace {

std::string edited(const std::string& text, const std::map<std::string, std::string>& values) {
  const auto result = with_operator_values(text, values, our_units());
  return result ? result.value()
                : std::string(result.error().where.view()) + ": " + std::string(result.error().message.view());
}

constexpr const char* kText =
    "# the arm\nsubsystem: s\ntasks:\n  a:   {component: c}   # kp: 3\n\n"
    "operator:  # the gains\n"
    "  kp: [100 N.m/rad,   # shoulder\n       90 N.m/rad]   # elbow\n"
    "  goal: 180 deg\t# half a turn\n"
    "  name: 'it''s # here'  # a text\n"
    "  pose: {x: 1 m, y: 2 m}\n"
    "configurations:\n  run: [a]";

TEST(OperatorText, OnlyTheValuesThatDifferChange) {
  EXPECT_EQ(edited(kText, {{"goal", "1.5 rad"}, {"name", "\"new\""}, {"pose", "{x: 1 m, y: 3 m}"},
                           {"kp", "[100 N.m/rad, 80 N.m/rad]"}}),
            "# the arm\nsubsystem: s\ntasks:\n  a:   {component: c}   # kp: 3\n\n"
            "operator:  # the gains\n"
            "  kp: [100 N.m/rad, 80 N.m/rad]   # elbow\n"
            "  goal: 1.5 rad\t# half a turn\n"
            "  name: \"new\"  # a text\n"
            "  pose: {x: 1 m, y: 3 m}\n"
            "configurations:\n  run: [a]");
}

TEST(OperatorText, AnEqualValueStaysAsItIsWritten) {
  EXPECT_EQ(edited(kText, {{"goal", "3.141592653589793 rad"}, {"kp", "[100 N.m/rad, 90 N.m/rad]"},
                           {"name", "\"it's # here\""}, {"pose", "{y: 2 m, x: 1 m}"}}),
            kText);
  const std::string broadcast = "subsystem: s\ntasks: {a: }\noperator: {kp: 2 m, ki: 3}\n";
  EXPECT_EQ(edited(broadcast, {{"kp", "[2 m, 2 m]"}}), broadcast);
  EXPECT_EQ(edited(broadcast, {{"kp", "[2 m, 3 m]"}, {"ki", "4"}}),
            "subsystem: s\ntasks: {a: }\noperator: {kp: [2 m, 3 m], ki: 4}\n");
}

TEST(OperatorText, ReplacesValuesThatHaveLinesOfTheirOwnOneByOne) {
  const std::string head = "subsystem: s\ntasks: {a: }\noperator:\n";
  EXPECT_EQ(edited(head + "  kp:\n    - 1 m  # near\n    # far\n    - 2 m\n  ki: 3\n",
                   {{"kp", "[1 m, 7 m]"}, {"ki", "4"}}),
            head + "  kp:\n    - 1 m  # near\n    # far\n    - 7 m\n  ki: 4\n");
  EXPECT_EQ(edited(head + "  m:\n    - [1, 2]\n    - [3, 4]\n", {{"m", "[[1, 2], [5, 6]]"}}),
            head + "  m:\n    - [1, 2]\n    - [5, 6]\n");
  EXPECT_EQ(edited(head + "  pose:\n    x: 1 m\n    y: 2 m\n", {{"pose", "{y: 3 m, x: 1 m}"}}),
            head + "  pose:\n    x: 1 m\n    y: 3 m\n");
}

TEST(OperatorText, RefusesAValueWithoutAPlace) {
  EXPECT_EQ(edited(kText, {{"kd", "1"}}), "kd: is not under `operator:`");
  EXPECT_EQ(edited("subsystem: s\ntasks: {a: }\noperator:\n  kp:\n    - 1\n    - 2\n", {{"kp", "[1, 3, 4]"}}),
            "kp: is written over several lines, and its number of elements has changed: edit the file by hand");
  EXPECT_EQ(edited("[", {{"kp", "1"}}), ": the description cannot be read");
  EXPECT_EQ(edited(kText, {{"kp", "[1"}}), "kp: '[1' is no value");
}

}  // namespace
}  // namespace chimera::cli
