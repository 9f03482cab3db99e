// SPDX-License-Identifier: Apache-2.0
#include "chimera/text/nearest.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(Nearest, CountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("rate", "rate"), 0u);
  EXPECT_EQ(edit_distance("rate", "rates"), 1u);
  EXPECT_EQ(edit_distance("rate", "ate"), 1u);
  EXPECT_EQ(edit_distance("rate", "rite"), 1u);
  EXPECT_EQ(edit_distance("rate", "raet"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(Nearest, GivesTheNearestAndTheFirstOfEquals) {
  const std::vector<std::string> names{"pid_joint", "puma_torque", "gain", "main"};
  EXPECT_EQ(nearest("pid_jont", names), "pid_joint");
  EXPECT_EQ(nearest("bain", names), "gain");
}

TEST(Nearest, PrefersAnotherCaseToAnotherLetter) {
  const std::vector<std::string> names{"n", "s", "N"};
  EXPECT_EQ(nearest("S", names), "s");
  const std::vector<std::string> units{"ppm", "rpm"};
  EXPECT_EQ(nearest("RPM", units), "rpm");
}

TEST(Nearest, GivesAnUnfinishedNameItsEnd) {
  const std::vector<std::string> names{"speed", "error_now", "error_before"};
  EXPECT_EQ(nearest("err", names), "error_now");
  EXPECT_EQ(nearest("er", names), "");
}

TEST(Nearest, GivesNothingWhenNothingIsNear) {
  const std::vector<std::string> names{"puma_torque"};
  EXPECT_EQ(nearest("gain", names), "");
  EXPECT_EQ(nearest("", names), "");
  EXPECT_EQ(nearest("puma_torque", names), "");
}

TEST(Nearest, TakesHostileLengthsInStride) {
  const std::vector<std::string> names{std::string(1 << 20, 'a')};
  EXPECT_EQ(nearest(std::string(1 << 20, 'b'), names), "");
}

TEST(Nearest, EndsAMessageOnlyIfANameIsNear) {
  const std::vector<std::string> names = {"pid", "lqr"};
  EXPECT_EQ(no_such("task", "pdi", names), "no task 'pdi'; did you mean 'pid'?");
  EXPECT_EQ(no_such("task", "arm", names), "no task 'arm'");
  EXPECT_EQ(did_you_mean("N.m", '"'), "; did you mean \"N.m\"?");
}

}  // namespace
}  // namespace chimera
