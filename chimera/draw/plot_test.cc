// SPDX-License-Identifier: Apache-2.0
#include "chimera/draw/plot.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chimera::draw::plot_test {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

Curve wave(const std::string& name, const std::string& unit, int points, double height = 1) {
  Curve curve{name, unit, {}};
  for (int i = 0; i < points; ++i) curve.points.push_back({i * 1e-3, height * std::sin(i * 0.05)});
  return curve;
}

Plot plot_of(std::vector<Curve> curves, std::string title = "t") {
  Plot plot;
  plot.title = std::move(title);
  plot.curves = std::move(curves);
  return plot;
}

/// Every M and L of the first path that is a curve of the panel (not of the legend).
std::string first_path(const std::string& picture) {
  const std::size_t group = picture.find("<g clip-path");
  const std::size_t at = picture.find("d=\"", group) + 3;
  return picture.substr(at, picture.find('"', at) - at);
}

TEST(Plot, MarksAreRoundNumbersWithinTheRange) {
  EXPECT_EQ(axis_marks(0, 1, 5), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
  EXPECT_EQ(axis_marks(-7, 13, 4), (std::vector<double>{-5, 0, 5, 10}));
  EXPECT_EQ(axis_marks(1, 1, 4), std::vector<double>{});
  for (double low = 1e-12; low < 1e12; low *= 7.3)
    for (double wide = low * 1e-3; wide < low * 1e3; wide *= 3.7) {
      const std::vector<double> marks = axis_marks(low, low + wide, 5);
      ASSERT_GE(marks.size(), 2u) << low << " " << wide;
      ASSERT_LE(marks.size(), 12u) << low << " " << wide;
      ASSERT_GE(marks.front(), low - wide * 1e-6);
      ASSERT_LE(marks.back(), low + wide * (1 + 1e-6));
    }
}

TEST(Plot, AMarkedCurveHasACircleForEachFinitePoint) {
  Curve curve = wave("gain", "1", 7);
  curve.points[3].value = kNothing;
  EXPECT_EQ(count(svg(plot_of({curve})), "<circle"), 0u);
  curve.has_marks = true;
  EXPECT_EQ(count(svg(plot_of({curve})), "<circle"), 6u);
}

TEST(Plot, OverFrequencyEveryDecadeIsAsWide) {
  EXPECT_EQ(decade_marks(1, 10), (std::vector<double>{1, 2, 5, 10}));
  EXPECT_EQ(decade_marks(0.3, 30), (std::vector<double>{0.5, 1, 2, 5, 10, 20}));
  EXPECT_TRUE(decade_marks(0, 10).empty());
  Plot plot = plot_of({{"gain", "dB", {{1, 0}, {10, -20}, {100, -40}}}});
  plot.is_over_frequency = true;
  const std::string picture = svg(plot);
  EXPECT_EQ(count(picture, "frequency [Hz]"), 1u);
  EXPECT_EQ(count(picture, "time [s]"), 0u);
  EXPECT_EQ(first_path(picture), "M78,89.25 L508,183 L938,276.75");  // a straight line falls 20 dB a decade
}

TEST(Plot, OnePanelForEachRtpuOverTheSameTime) {
  const Plot plot = plot_of({wave("q[0]", "rad", 50), wave("tau", "N.m", 50), wave("q[1]", "rad", 50)});
  const std::string picture = svg(plot);
  EXPECT_EQ(count(picture, "<clipPath"), 2u);
  EXPECT_EQ(count(picture, "[rad]"), 1u);
  EXPECT_EQ(count(picture, "[N.m]"), 1u);
  EXPECT_EQ(count(picture, "time [s]"), 1u);
  for (const char* name : {">q[0]<", ">q[1]<", ">tau<"}) EXPECT_EQ(count(picture, name), 1u) << name;
}

TEST(Plot, ALineEndsWhereAValueIsMissing) {
  const Plot plot = plot_of({{"a", "1", {{0, 1}, {1, 2}, {2, kNothing}, {3, 1}, {4, 0}}}});
  EXPECT_EQ(count(first_path(svg(plot)), "M"), 2u);
  EXPECT_EQ(count(first_path(svg(plot)), "L"), 2u);
}

TEST(Plot, AHeldValueIsDrawnAsSteps) {
  Plot plot = plot_of({{"a", "1", {{0, 0}, {1, 0}, {2, 1}, {4, 0}}}});
  EXPECT_EQ(first_path(svg(plot)), "M78,276.75 L293,276.75 L508,89.25 L938,276.75") << "a ramp from one to the next";
  plot.curves[0].is_held = true;
  EXPECT_EQ(first_path(svg(plot)), "M78,276.75 L293,276.75 L508,276.75 L508,89.25 L938,89.25 L938,276.75");
  plot.curves[0].points = {{0, 0}, {1, 1}, {2, kNothing}, {3, 0}, {4, 1}};
  EXPECT_EQ(count(first_path(svg(plot)), "M"), 2u) << "no value is held over a gap";
}

TEST(Plot, GapsAreHatchedAndSayHowMuchIsMissing) {
  Plot plot = plot_of({wave("a", "1", 9), wave("b", "m", 9)});
  plot.gaps = {{0.002, 0.004, "12 rows of pid lost"}};
  const std::string picture = svg(plot);
  EXPECT_EQ(count(picture, "url(#gap)"), 2u) << "in every panel";
  EXPECT_EQ(count(picture, "12 rows of pid lost"), 1u);
}

TEST(Plot, APeakOfOnePointAmongAMillionIsSeen) {
  Curve curve{"a", "1", {}};
  for (int i = 0; i < 1'000'000; ++i) curve.points.push_back({i * 1e-6, i == 345'678 ? 5.0 : 0.0});
  const std::string picture = svg(plot_of({std::move(curve)}));
  EXPECT_LT(picture.size(), 100'000u);
  // The path reaches to near the upper edge of the panel, which lies 6 % of the range above the peak.
  EXPECT_NE(first_path(picture).find(",89.2"), std::string::npos) << first_path(picture);
}

TEST(Plot, SaysThatThereIsNoData) {
  EXPECT_EQ(count(svg(plot_of({})), "no values"), 1u);
  EXPECT_EQ(count(svg(plot_of({{"a", "1", {{0, kNothing}}}})), "no values"), 1u);
}

TEST(Plot, AConstantLiesInTheMiddleAndALonePointIsADot) {
  Plot plot = plot_of({{"a", "1", {{0, 3}, {1, 3}}}});
  EXPECT_NE(first_path(svg(plot)).find("M78,183 L938,183"), std::string::npos) << first_path(svg(plot));
  plot.curves[0].points.pop_back();
  EXPECT_EQ(count(first_path(svg(plot)), "L"), 1u);
}

TEST(Plot, TextsCannotBreakTheDocument) {
  const std::string picture = svg(plot_of({{"x<y", "1", {{0, 1}}}}, "<a & \"b\">"));
  EXPECT_NE(picture.find("&lt;a &amp; &quot;b&quot;&gt;"), std::string::npos);
  EXPECT_NE(picture.find("x&lt;y"), std::string::npos);
}

}  // namespace
}  // namespace chimera::draw::plot_test
