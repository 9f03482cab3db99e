// SPDX-License-Identifier: Apache-2.0
// A function of time or distance in one line of text: "0:0 5:0.4 8:0" is 0 from 0, 0.4 from 5, 0 from 8. It replaces a
// foot, a button or a road in a simulation.
#pragma once

#include <cstddef>
#include <string_view>

#include "chimera/base/fixed.h"
#include "chimera/base/number_text.h"

namespace chimera::library {

/// A function given by points with rising arguments. Before the first point it has the first value.
class Script {
 public:
  static constexpr std::size_t kMostPoints = 32;

  /// Reads "at:value at:value ...", at most 32 points, arguments rising, all numbers finite. Returns nullptr, or the
  /// error; the script is then empty. Context: setup.
  const char* read(std::string_view text) noexcept {
    points_.clear();
    const char* wrong = read_points(text);
    if (wrong != nullptr) points_.clear();
    return wrong;
  }
  /// Reads a script. Returns `outside` if a value is not within `low` to `high`.
  const char* read(std::string_view text, double low, double high, const char* outside) noexcept {
    if (const char* wrong = read(text)) return wrong;
    for (const Point& point : points_)
      if (point.value < low || point.value > high) {
        points_.clear();
        return outside;
      }
    return nullptr;
  }

  /// Value of the last point at or before `at`. 0 without points. Context: cycle; wait-free.
  double step(double at) const noexcept {
    const std::size_t n = passed(at);
    return points_.empty() ? 0 : points_[n == 0 ? 0 : n - 1].value;
  }

  /// Value on the straight line between the points around `at`. 0 without points. Context: cycle; wait-free.
  double line(double at) const noexcept {
    const std::size_t n = passed(at);
    if (n == 0 || n == points_.size()) return step(at);
    const Point &a = points_[n - 1], &b = points_[n];
    return a.value + (b.value - a.value) * (at - a.at) / (b.at - a.at);
  }

 private:
  struct Point {
    double at = 0;
    double value = 0;
  };

  static bool take_number(std::string_view& text, double& number) noexcept {
    const ReadNumber read = read_number(text);
    if (read.length == 0 || !read.in_range) return false;
    number = read.value;
    text.remove_prefix(read.length);
    return true;
  }

  const char* read_points(std::string_view text) noexcept {
    while (true) {
      while (text.starts_with(' ')) text.remove_prefix(1);
      if (text.empty()) return points_.empty() ? "the script is empty: write at:value at:value ..." : nullptr;
      Point point;
      if (!take_number(text, point.at)) return "a point of the script does not begin with a number";
      if (!text.starts_with(':')) return "a point of the script has no ':' after its first number";
      text.remove_prefix(1);
      if (!take_number(text, point.value)) return "a point of the script has no number after ':'";
      if (!text.empty() && !text.starts_with(' ')) return "a point of the script does not end with its second number";
      if (!points_.empty() && point.at <= points_[points_.size() - 1].at) return "the points of the script do not rise";
      if (!points_.try_push(point)) return "the script has more than 32 points";
    }
  }

  std::size_t passed(double at) const noexcept {
    std::size_t n = 0;
    while (n < points_.size() && points_[n].at <= at) ++n;
    return n;
  }

  FixedVector<Point, kMostPoints> points_;
};

}  // namespace chimera::library
