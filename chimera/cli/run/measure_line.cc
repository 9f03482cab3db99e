// SPDX-License-Identifier: Apache-2.0
// Subscribes to the measured variables of a running subsystem and hands their values to the measures.
#include "chimera/cli/run/measure_line.h"

#include <algorithm>

#include "chimera/cli/live/channel.h"
#include "chimera/platform/clock.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

constexpr Nanoseconds kLastRows = milliseconds(50);  // rows of the end are under way
constexpr int kValuesEvery = 20;                     // ms: the shortest period

}  // namespace

Result<void> MeasureLine::subscribe() {
  Json names = Json::array();
  for (const Measure& measure : measures_)
    if (std::find(names.begin(), names.end(), measure.variable()) == names.end()) names.push_back(measure.variable());
  const auto answer = line_.ask("get", {{"variables", names}});
  if (!answer) return answer.error();
  Json produced = Json::array(), given = Json::array();
  for (const auto& [name, reading] : (*answer)["values"].items()) {
    known_[name] = {text_at(reading, "unit", "1"), text_at(reading, "shape").empty()};
    (text_at(reading, "producer") == "operator" ? given : produced).push_back(name);
  }
  if (!produced.empty())
    if (auto tap = line_.ask("subscribe", {{"to", "tap"}, {"variables", produced}}); !tap) return tap.error();
  if (given.empty()) return {};
  auto values = line_.ask("subscribe", {{"to", "values"}, {"variables", given}, {"period_ms", kValuesEvery}});
  return values ? Result<void>() : values.error();
}

void MeasureLine::poll(Nanoseconds instant) {
  if (!line_.is_connected()) {
    has_gap_ = true;
    if (subscribe()) return;
    LinuxClock().wait_until(std::min(instant, LinuxClock().now() + milliseconds(10)));
    return;
  }
  const auto heard = line_.notification(instant);
  if (!heard) return;
  if (heard->contains("values"))
    for (const auto& [name, reading] : (*heard)["values"].items())
      if (truth_at(reading, "valid")) add(name, reading["value"], {whole_at(*heard, "at_ns")});
  if (!heard->contains("rows")) return;
  has_gap_ = has_gap_ || whole_at(*heard, "lost") > 0;
  const Json& variables = (*heard)["variables"];
  for (const Json& row : (*heard)["rows"])
    for (std::size_t v = 0; v < variables.size(); ++v) add(variables[v].as_string(), row[v + 2], {row[0].as_int64()});
}

void MeasureLine::add(const std::string& variable, const Json& value, Nanoseconds at) {
  if (at > end_) return;
  const Known& known = known_[variable];
  Seen seen{true, {}, {}};
  std::vector<std::string> names;
  for (const ChannelNumber& number : numbers_of(value, "")) {
    names.push_back(variable + (known.is_scalar ? "" : number.part));
    seen.numbers.push_back(number.value);
  }
  for (Measure& measure : measures_) {
    if (measure.variable() != variable) continue;
    if (const auto bound = measure.bind(names, std::vector(names.size(), known.unit)); bound)
      measure.add_sample(seen, at - started_);
    else
      refusals_[measure.text()] = bound.error().message.c_str();
  }
}

void MeasureLine::finish(Nanoseconds end, bool is_whole, RunReport& report) {
  if (!is_needed()) return;
  end_ = end;
  const Nanoseconds until = LinuxClock().now() + kLastRows;
  while (line_.is_connected() && LinuxClock().now() < until) poll(until);
  for (Measure& measure : measures_) {
    RunReport::Judged judged{measure.text(), is_whole ? "" : "the process that measures died: not known", false};
    if (is_whole) judged.holds = measure.holds(judged.said);
    if (refusals_.contains(measure.text())) judged.said = refusals_[measure.text()];
    if (is_whole && has_gap_) judged.said += "; samples are missing";
    report.expectations.push_back(std::move(judged));
  }
}

}  // namespace chimera::cli
