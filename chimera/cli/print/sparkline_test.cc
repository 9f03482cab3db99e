// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/sparkline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace chimera::cli {
namespace {

TEST(Sparkline, GoesFromTheLeastToTheGreatest) {
  const std::vector<double> ramp = {0, 1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(sparkline(ramp, 20, true), "\u2581\u2582\u2583\u2584\u2585\u2586\u2587\u2588");
  EXPECT_EQ(sparkline(std::vector<double>{0, 1, 2, 3, 4, 5, 6}, 20, false), "_.-=+*#");
}

TEST(Sparkline, ShowsTheLastValuesThatFit) {
  EXPECT_EQ(sparkline(std::vector<double>{9, 0, 1}, 2, false), "_#");
  EXPECT_EQ(sparkline({}, 5, true), "");
}

TEST(Sparkline, AConstantIsInTheMiddleAndANonFiniteNumberIsBlank) {
  EXPECT_EQ(sparkline(std::vector<double>{3, 3}, 5, false), "==");
  EXPECT_EQ(sparkline(std::vector<double>{NAN, 0, INFINITY, 1}, 5, false), " _ #");
  const double most = std::numeric_limits<double>::max();
  EXPECT_EQ(sparkline(std::vector<double>{-most, most}, 5, false), "_#");
}

TEST(Sparkline, TheLocaleDecidesAboutUnicode) {
  setenv("LC_ALL", "C", 1);
  EXPECT_FALSE(writes_unicode());
  setenv("LC_ALL", "en_GB.UTF-8", 1);
  EXPECT_TRUE(writes_unicode());
  setenv("LC_ALL", "", 1);
  setenv("LC_CTYPE", "C.utf8", 1);
  EXPECT_TRUE(writes_unicode());
}

}  // namespace
}  // namespace chimera::cli
