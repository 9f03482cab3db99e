// SPDX-License-Identifier: Apache-2.0
// Draws a plot in characters.
#include "chimera/cli/print/sketch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/columns.h"
#include "chimera/cli/print/sparkline.h"

namespace chimera::cli {
namespace {

constexpr double kNoPoint = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kRangeWidth = 30;
constexpr std::size_t kLeastCourse = 8;

struct Span {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  }
  bool empty() const { return low > high; }
};

std::string range_text(const draw::Curve& curve) {
  Span range;
  for (const draw::PlotPoint& point : curve.points) range.include(point.value);
  if (range.empty()) return "nothing";
  char text[80];
  std::snprintf(text, sizeof text, "%.4g .. %.4g", range.low, range.high);
  return with_unit(text, curve.unit);
}

/// The value at each of `count` instants of `time`, the last that was there.
std::vector<double> course_of(const draw::Curve& curve, const Span& time, std::size_t count) {
  std::vector<double> values(count, kNoPoint);
  const double all = time.high - time.low;
  for (const draw::PlotPoint& point : curve.points) {
    const double part = all > 0 ? std::clamp((point.at - time.low) / all, 0.0, 1.0) : 0;
    values[static_cast<std::size_t>(part * static_cast<double>(count - 1))] = point.value;
  }
  for (std::size_t i = 1; i < count; ++i)
    if (std::isnan(values[i])) values[i] = values[i - 1];
  return values;
}

}  // namespace

std::string sketch(const draw::Plot& plot, std::size_t width, bool unicode) {
  std::size_t name_width = 1;
  Span time;
  for (const draw::Curve& curve : plot.curves) {
    name_width = std::max(name_width, width_of(curve.name));
    for (const draw::PlotPoint& point : curve.points) time.include(point.at);
  }
  const std::size_t taken = name_width + kRangeWidth + 4;
  const std::size_t course = width > taken + kLeastCourse ? width - taken : kLeastCourse;
  std::string text;
  for (const draw::Curve& curve : plot.curves)
    text += fitted(curve.name, name_width) + "  " + sparkline(course_of(curve, time, course), course, unicode) + "  " +
            range_text(curve) + "\n";
  return text;
}

}  // namespace chimera::cli
