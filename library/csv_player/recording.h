// SPDX-License-Identifier: Apache-2.0
// A CSV file in memory: each row has a time and the same number of values.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/recording_text.h"

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

/// A column to play: its name in the head, and the unit of the output.
struct WantedColumn {
  std::string name, unit;
};

/// Reads line by line. Throws std::runtime_error with file and line for a bad line.
class RecordingReader {
 public:
  RecordingReader(const char* path, const std::vector<WantedColumn>& wanted) : path_(path), wanted_(wanted) {
    made_.columns_ = wanted.size();
  }

  /// Finds the wanted columns by name, and compares their units.
  void head(std::string_view line) {
    if (const std::string why = foreign_head(line); !why.empty()) fail(why);
    const auto fields = fields_of(line);
    fields_ = fields.size();
    for (const WantedColumn& wanted : wanted_) {
      const auto has_name = [&](std::string_view field) { return column_head(field).name == wanted.name; };
      const auto at = std::find_if(fields.begin() + 1, fields.end(), has_name);
      if (at == fields.end())
        fail("has no column '" + wanted.name + "': name the recorded variable with the constant `columns`");
      if (std::find_if(at + 1, fields.end(), has_name) != fields.end()) fail("has '" + wanted.name + "' twice");
      const ColumnHead found = column_head(*at);
      const std::string_view unit = found.unit.empty() ? wanted.unit : found.unit;
      if (unit != wanted.unit)
        fail("'" + wanted.name + "' is in " + std::string(unit) + ", and the output takes " + wanted.unit);
      places_.push_back(static_cast<std::size_t>(at - fields.begin()));
    }
  }
  /// An empty field keeps the value of the previous row, which must exist.
  void row(std::string_view line) {
    if (const std::string why = foreign_line(line); !why.empty()) fail(why);
    const auto fields = fields_of(line);
    const double time = number(fields[0], "the time");
    if (made_.times_.empty()) origin_ = time;
    else if (!(time - origin_ > made_.times_.back())) fail("the time does not grow");
    if (fields.size() < fields_) fail("has fewer fields than the first line");
    if (fields.size() > fields_) fail("has more fields than the first line; numbers have a decimal point");
    made_.times_.push_back(time - origin_);
    for (const std::size_t place : places_) {
      if (!fields[place].empty()) made_.values_.push_back(number(fields[place], "a field"));
      else if (made_.times_.size() == 1) fail("a field of the first row is empty");
      else made_.values_.push_back(made_.values_[made_.values_.size() - made_.columns_]);
    }
    if (made_.values_.size() > kMostValues) fail("more than 8000000 values");
  }
  void next() { ++line_; }
  Recording take() {
    if (made_.times_.empty()) throw std::runtime_error(path_ + ": there is no row in it");
    return std::move(made_);
  }

 private:
  static constexpr std::size_t kMostValues = 8'000'000;

  double number(std::string_view field, const char* what) const {
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value))
      fail(std::string(what) + " is not a finite number");
    return value;
  }
  [[noreturn]] void fail(const std::string& text) const {
    throw std::runtime_error(path_ + ":" + std::to_string(line_) + ": " + text);
  }

  std::string path_;
  const std::vector<WantedColumn>& wanted_;
  std::vector<std::size_t> places_;  // of the wanted columns in a line
  std::size_t fields_ = 0;           // of each line
  std::size_t line_ = 0;
  double origin_ = 0;
  Recording made_;
};

inline constexpr std::size_t kMostBytes = std::size_t{1} << 30;

/// Reads the wanted columns of a file. Throws std::runtime_error. Context: setup; may block.
inline Recording read_recording(const char* path, const std::vector<WantedColumn>& wanted) {
  if (const std::string why = not_ordinary(path, kMostBytes); !why.empty())
    throw std::runtime_error(std::string(path) + ": " + why);
  std::ifstream file(path);
  if (!file) throw std::runtime_error(std::string(path) + ": cannot be read");
  RecordingReader reader(path, wanted);
  std::string line;
  for (bool is_first = true; std::getline(file, line); is_first = false) {
    reader.next();
    const std::string_view plain = recording_line(line);
    if (is_first) reader.head(plain);
    else if (!plain.empty()) reader.row(plain);
  }
  return reader.take();
}

}  // namespace chimera::library
