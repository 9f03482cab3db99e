// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/sketch.h"

#include <gtest/gtest.h>

#include <limits>

namespace chimera::cli {
namespace {

TEST(Sketch, ShowsTheCourseAndTheRangeOfEachCurve) {
  draw::Plot plot;
  draw::Curve ramp{"speed", "rad/s", {}}, step{"on", "1", {}};
  for (int i = 0; i <= 6; ++i) ramp.points.push_back({i * 0.1, i * 1.0});
  step.points = {{0, 0}, {0.3, 1}};  // held to the end
  plot.curves = {ramp, step, {"none", "V", {{0.2, std::numeric_limits<double>::quiet_NaN()}}}};
  EXPECT_EQ(sketch(plot, 0, false),
            "speed  _.-=+**#  0 .. 6 rad/s\n"
            "on     ___#####  0 .. 1\n"
            "none             nothing\n");
}

TEST(Sketch, TakesTheWidthOfTheTerminal) {
  draw::Plot plot;
  plot.curves = {{"x", "1", {{0, 1}, {1, 2}}}};
  const std::string text = sketch(plot, 80, false);
  EXPECT_EQ(text.find("1 .. 2"), 80u - 30 - 4 - 1 + 5);
}

}  // namespace
}  // namespace chimera::cli
