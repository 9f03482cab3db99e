// SPDX-License-Identifier: Apache-2.0
// A CSV file in memory: each row has a time and the same number of values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "chimera/base/hosted/ordinary_file.h"

namespace chimera::library {

class Recording {
 public:
  /// Times are in s since the first row. Context: cycle; wait-free.
  std::size_t rows() const noexcept { return times_.size(); }
  double time(std::size_t row) const noexcept { return times_[row]; }
  double length() const noexcept { return times_.back(); }
  /// Returns the last row at or before `t`: at most 32 steps for 2^32 rows.
  std::size_t row_at(double t) const noexcept {
    const auto behind = std::upper_bound(times_.begin(), times_.end(), t);
    return behind == times_.begin() ? 0 : static_cast<std::size_t>(behind - times_.begin()) - 1;
  }
  /// Value of `column`, interpolated: `part` (0 to 1) of the way from `row` to the next row.
  double value(std::size_t row, std::size_t column, double part) const noexcept {
    const double here = values_[row * columns_ + column];
    return part > 0 ? here + part * (values_[(row + 1) * columns_ + column] - here) : here;
  }

 private:
  friend class RecordingReader;

  std::size_t columns_ = 0;
  std::vector<double> times_, values_;
};

/// Reads line by line. Throws std::runtime_error with file and line for a bad line.
class RecordingReader {
 public:
  RecordingReader(const char* path, std::size_t columns) : path_(path) { made_.columns_ = columns; }

  void head(const std::string& line) {
    const auto fields = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
    if (fields != made_.columns_)
      fail("has " + std::to_string(fields) + " columns after the time, and there are " +
           std::to_string(made_.columns_) + " outputs");
  }
  /// An empty field keeps the value of the previous row, which must exist.
  void row(const std::string& line) {
    const char* at = line.c_str();
    const double time = number(at, "the time");
    if (made_.times_.empty()) origin_ = time;
    else if (!(time - origin_ > made_.times_.back())) fail("the time does not grow");
    made_.times_.push_back(time - origin_);
    for (std::size_t i = 0; i < made_.columns_; ++i) {
      if (*at++ != ',') fail("has fewer fields than the first line");
      if (*at != ',' && *at != '\0') made_.values_.push_back(number(at, "a field"));
      else if (made_.times_.size() == 1) fail("a field of the first row is empty");
      else made_.values_.push_back(made_.values_[made_.values_.size() - made_.columns_]);
    }
    if (*at != '\0') fail("has more fields than the first line");
    if (made_.values_.size() > kMostValues) fail("more than 8000000 values");
  }
  void next() { ++line_; }
  Recording take() {
    if (made_.times_.empty()) throw std::runtime_error(path_ + ": there is no row in it");
    return std::move(made_);
  }

 private:
  static constexpr std::size_t kMostValues = 8'000'000;

  double number(const char*& at, const char* what) const {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at || !std::isfinite(value)) fail(std::string(what) + " is not a finite number");
    at = end;
    return value;
  }
  [[noreturn]] void fail(const std::string& text) const {
    throw std::runtime_error(path_ + ":" + std::to_string(line_) + ": " + text);
  }

  std::string path_;
  std::size_t line_ = 0;
  double origin_ = 0;
  Recording made_;
};

inline constexpr std::size_t kMostBytes = std::size_t{1} << 30;

/// Reads a file with `columns` values after the time. Throws std::runtime_error. Context: setup; may block.
inline Recording read_recording(const char* path, std::size_t columns) {
  if (const std::string why = not_ordinary(path, kMostBytes); !why.empty())
    throw std::runtime_error(std::string(path) + ": " + why);
  std::ifstream file(path);
  if (!file) throw std::runtime_error(std::string(path) + ": cannot be read");
  RecordingReader reader(path, columns);
  std::string line;
  for (bool is_first = true; std::getline(file, line); is_first = false) {
    reader.next();
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (is_first) reader.head(line);
    else if (!line.empty()) reader.row(line);
  }
  return reader.take();
}

}  // namespace chimera::library
