// SPDX-License-Identifier: Apache-2.0
// Lays out a line for each watched variable with its value, range and sparkline.
#include "chimera/cli/live/watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/columns.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/sparkline.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

std::string number_text(double value) { return formatted("%.4g", value); }

/// The text of a reading; of a part its numbers with the unit.
std::string text_of_part(const Json& reading, const std::string& part, const std::vector<ChannelNumber>& numbers) {
  if (part.empty() || !truth_at(reading, "valid")) return text_of(reading, "text");
  if (numbers.empty()) return "no such element";
  std::string text = join(numbers, " ", [](const ChannelNumber& n) { return formatted("%.6g", n.value); });
  if (numbers.size() > 1) text = "[" + text + "]";
  const std::string unit = text_of(reading, "unit");
  return unit.empty() ? text : with_unit(text, unit);
}

std::string range_text(const std::deque<double>& course) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : course)
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  return low > high ? "" : number_text(low) + " .. " + number_text(high);
}

}  // namespace

Watch::Watch(std::vector<ChannelName> channels) {
  for (ChannelName& name : channels) watched_.push_back({std::move(name), "?", "", {}});
}

void Watch::add(const Json& values) {
  for (Watched& watched : watched_) {
    const Json& reading = values[watched.name.variable];
    if (!reading.is_object()) continue;
    const auto numbers = numbers_of(reading["value"], watched.name.part);
    watched.text = text_of_part(reading, watched.name.part, numbers);
    const std::string producer = text_of(reading, "producer"), state = text_of(reading, "state");
    watched.remark = producer.empty() ? "no producer" : producer + " is " + state;
    if (state == "ON" || state.empty()) watched.remark.clear();
    watched.course.push_back(numbers.empty() ? std::numeric_limits<double>::quiet_NaN() : numbers[0].value);
    if (watched.course.size() > kKept) watched.course.pop_front();
  }
}

std::vector<std::string> Watch::lines(std::size_t width, bool unicode) const {
  std::size_t name_width = 1, text_width = 12;
  for (const Watched& watched : watched_) {
    name_width = std::max(name_width, (watched.name.variable + watched.name.part).size());
    text_width = std::max(text_width, width_of(watched.text));
  }
  name_width = std::min(name_width, width / 4);
  // Steps of four columns, so that the course does not jump with every digit of a value.
  text_width = std::min((text_width + 3) / 4 * 4, width / 2);
  const std::size_t taken = name_width + text_width + 4;
  const std::size_t course_width = width > taken + 24 ? width - taken - 24 : 0;
  std::vector<std::string> lines;
  for (const Watched& watched : watched_) {
    const std::vector<double> course(watched.course.begin(), watched.course.end());
    std::string line = fitted(watched.name.variable + watched.name.part, name_width) + "  " +
                       fitted(watched.text, text_width) + "  " +
                       fitted(sparkline(course, course_width, unicode), course_width) + "  " +
                       (watched.remark.empty() ? range_text(watched.course) : watched.remark);
    lines.push_back(fitted(line, width));
  }
  return lines;
}

std::string Watch::plain() const {
  return join(watched_, "  ", [](const Watched& watched) {
    return watched.name.variable + watched.name.part + " = " + watched.text +
           (watched.remark.empty() ? "" : " (" + watched.remark + ")");
  });
}

}  // namespace chimera::cli
