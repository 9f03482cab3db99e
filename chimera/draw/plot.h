// SPDX-License-Identifier: Apache-2.0
// Values over time or frequency as a picture: at least one panel for each unit, stacked over one axis, with a colour
// for each channel.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace chimera::draw {

struct PlotPoint {
  double at = 0;     ///< s; over frequency Hz, above 0
  double value = 0;  ///< in the unit of the curve; not finite: the line has a gap here
};

struct Curve {
  std::string name;
  std::string unit = "1";
  std::vector<PlotPoint> points;  ///< in order of time
  int panel = 0;                  ///< curves of one unit with an equal number share a panel
  bool is_held = false;  ///< a value holds until the next one: drawn as steps, not as a line from one to the next
  bool has_marks = false;  ///< each point has a circle
};

/// A time range with missing values: hatched over the whole height, with its text.
struct PlotGap {
  double from = 0, to = 0;  ///< s
  std::string text;         ///< "12 rows of pid lost"
};

struct Plot {
  std::string title;
  std::string note;  ///< a line under the title; may be empty
  std::vector<Curve> curves;
  std::vector<PlotGap> gaps;
  std::optional<double> mark;  ///< a dashed line at this time, such as the trigger
  /// A level drawn in the panel of `level_unit`, such as the trigger's.
  double level = std::numeric_limits<double>::quiet_NaN();
  std::string level_unit;
  bool is_over_frequency = false;  ///< `at` is a frequency: its axis is logarithmic
  std::string across = {};         ///< name of `at`, if it is neither time nor frequency: "kp [N.m/rad]"
};

/// Marks of an axis: round numbers (1, 2, 5 times a power of ten) that lie within [low, high], about `wanted` of them,
/// at least 2 where low < high. Context: setup.
std::vector<double> axis_marks(double low, double high, int wanted);

/// Marks of a logarithmic axis: 1, 2 and 5 times the powers of ten within [low, high], 0 < low. Context: setup.
std::vector<double> decade_marks(double low, double high);

/// A whole SVG document. If a curve has more points than the picture has columns, each column shows its least and
/// greatest value, so that no peak is lost. Without any finite point the picture has only axes and a note. Context:
/// setup.
std::string svg(const Plot& plot);

}  // namespace chimera::draw
