// SPDX-License-Identifier: Apache-2.0
// Collects rows before and after a trigger and counts gaps.
#include "chimera/cli/live/scope.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/fields.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

constexpr Nanoseconds kForTheRest = seconds(1);
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

double seconds_between(Nanoseconds from, Nanoseconds to) { return static_cast<double>((to - from).count) * 1e-9; }

/// The numbers of `channel` in a row; none when the row does not have its variable.
std::vector<ChannelNumber> numbers_in_row(const Json& row, const std::vector<std::string>& variables,
                                          const ChannelName& channel, bool is_scalar) {
  const std::string& variable = channel.variable;
  const auto found = std::find(variables.begin(), variables.end(), variable);
  const auto index = static_cast<std::size_t>(found - variables.begin()) + 2;
  if (found == variables.end() || index >= row.size()) return {};
  const bool is_list_of_one = is_scalar && row[index].is_array() && row[index].size() == 1;
  return numbers_of(is_list_of_one ? row[index][0] : row[index], channel.part);
}

bool is_row(const Json& row) { return row.is_array() && row.size() >= 2 && row[0].is_whole() && row[1].is_whole(); }

/// False: a task that is OFF could produce the variable, and has not.
bool is_drawn(const draw::Curve& curve) {
  return std::ranges::any_of(curve.points, [](const draw::PlotPoint& point) { return !std::isnan(point.value); });
}

}  // namespace

Scope::Stream& Scope::stream(const std::string& rtpu, const std::string& task) {
  for (Stream& known : streams_)
    if (known.rtpu == rtpu && known.task == task) return known;
  return streams_.emplace_back(Stream{rtpu, task, {}, {}, {}, 0, {}});
}

bool Scope::is_in_window(Nanoseconds at) const noexcept {
  return begin_ && at >= *begin_ - request_.pre && at <= *begin_ + request_.duration;
}

void Scope::check_trigger(const Json& row, const std::vector<std::string>& variables, Nanoseconds at) {
  if (begin_) return;
  if (!request_.trigger) {
    begin_ = at;
    return;
  }
  const ChannelName& channel = request_.trigger->channel();
  if (std::find(variables.begin(), variables.end(), channel.variable) == variables.end()) return;
  const auto numbers = numbers_in_row(row, variables, channel, request_.trigger_is_scalar);
  trigger_seen_ = at;
  if (!request_.trigger->fires(numbers.empty() ? kNothing : numbers[0].value)) return;
  if (is_armed(at))
    begin_ = at;
  else
    ++early_edges_;
}

bool Scope::has_every_channel() const {
  std::vector<bool> seen(request_.channels.size());
  for (const Stream& stream : streams_)
    for (const Column& column : stream.columns) seen[column.channel] = true;
  return std::all_of(seen.begin(), seen.end(), [](bool was) { return was; });
}

// A task that has published nothing for a while longer than the pre-trigger is not waited for: it may be OFF.
bool Scope::is_armed(Nanoseconds at) const {
  if (request_.pre.count == 0) return true;
  Nanoseconds first = at;
  for (const Stream& stream : streams_) {
    if (!stream.oldest || *stream.oldest > at - request_.pre) return false;
    first = std::min(first, *stream.oldest);
  }
  return has_every_channel() || at - first >= request_.pre + kForTheRest;
}

void Scope::add_row(Stream& stream, const Json& row, const std::vector<std::string>& variables, std::uint64_t lost) {
  Row kept{{row[0].as_int64()}, row[1].as_uint64(), lost, lost > 0, {}};
  if (stream.next && stream.sequence > 0 && kept.sequence != stream.sequence + 1) {
    // Sequences count publications: a jump is a loss too, a step back is a task that was made anew.
    if (kept.sequence > stream.sequence) kept.lost = std::max(lost, kept.sequence - stream.sequence - 1);
    kept.is_break = true;
  }
  stream.sequence = kept.sequence;
  stream.newest = kept.at;
  if (!stream.oldest) stream.oldest = kept.at;
  check_trigger(row, variables, kept.at);
  kept.values.assign(stream.columns.size(), kNothing);
  for (std::size_t c = 0; c < request_.channels.size(); ++c) {
    const ScopeChannel& channel = request_.channels[c];
    for (const ChannelNumber& number : numbers_in_row(row, variables, channel.name, channel.is_scalar)) {
      const auto known = std::find_if(stream.columns.begin(), stream.columns.end(), [&](const Column& column) {
        return column.channel == c && column.part == number.part;
      });
      const auto index = static_cast<std::size_t>(known - stream.columns.begin());
      if (known == stream.columns.end()) stream.columns.push_back({c, number.part}), kept.values.push_back(kNothing);
      kept.values[index] = number.value;
    }
  }
  if (begin_ && kept.at > *begin_ + request_.duration) {
    if (!stream.is_past) stream.lost_after_window = kept.lost, stream.is_past = true;
    return;
  }
  stream.rows.push_back(std::move(kept));
  if (stream.rows.size() > kScopeRows) stream.rows.pop_front(), is_full_ = begin_.has_value();
}

void Scope::prune() {
  const Nanoseconds oldest = begin_ ? *begin_ - request_.pre : trigger_seen_ - request_.pre;
  for (Stream& stream : streams_)
    while (stream.rows.size() > 1 && stream.rows[1].at < oldest) stream.rows.pop_front();  // one holds into the window
}

void Scope::add(const Json& params) {
  const Json& rows = params["rows"];
  if (!rows.is_array()) return;
  Stream& of = stream(text_of(params, "rtpu"), text_of(params, "task"));
  const std::vector<std::string> variables = texts_of(params, "variables");
  const auto first = static_cast<std::uint64_t>(std::max<std::int64_t>(whole_of(params, "first"), 0));
  std::uint64_t lost = of.next && first > *of.next ? first - *of.next : 0;
  for (const Json& row : rows) {
    if (!is_row(row)) continue;
    add_row(of, row, variables, lost);
    lost = 0;
    of.next = 0;
  }
  of.next = first + rows.size();
  prune();
}

void Scope::add_values(const Json& params) {
  const std::int64_t now = whole_of(params, "at_ns");
  for (const auto& [name, reading] : params["values"].items()) {
    const Stream& of = stream("operator", name);
    const std::int64_t published = whole_of(reading, "published_ns");
    // The first value has held for long: it counts from now on.
    const std::int64_t at = of.oldest ? published : now;
    if (!of.oldest || published > of.newest.count)
      add({{"rtpu", "operator"},
           {"task", name},
           {"variables", Json::array({name})},
           {"first", of.next.value_or(0)},
           {"rows", Json::array({Json::array({at, of.sequence + 1, reading["value"]})})}});
    stream("operator", name).newest = Nanoseconds{now};
  }
}

bool Scope::is_complete() const {
  if (is_full_) return true;
  if (!begin_) return false;
  const auto is_behind = [this](const Stream& stream) { return stream.newest < *begin_ + request_.duration; };
  return std::none_of(streams_.begin(), streams_.end(), is_behind) && has_every_channel();
}

std::size_t Scope::rows() const {
  std::size_t n = 0;
  for (const Stream& stream : streams_)
    for (const Row& row : stream.rows) n += is_in_window(row.at) ? 1 : 0;
  return n;
}

std::uint64_t Scope::lost_rows() const {
  std::uint64_t n = 0;
  for (const Stream& stream : streams_)
    for (const Row& row : stream.rows) n += is_in_window(row.at) ? row.lost : 0;
  return n;
}

std::size_t Scope::gaps() const {
  std::size_t n = 0;
  for (const Stream& stream : streams_)
    for (const Row& row : stream.rows) n += is_in_window(row.at) && row.lost > 0 ? 1 : 0;
  return n;
}

std::string Scope::summary() const {
  std::string text = counted(rows(), "row");
  text += gaps() == 0 ? ", no gap" : "; " + counted(gaps(), "gap") + ", " + counted(lost_rows(), "row") + " lost";
  if (is_full_) text += "; cut at " + std::to_string(kScopeRows) + " rows";
  if (early_edges_ > 0) text += "; " + counted(early_edges_, "edge") + " before the pre-trigger was full ignored";
  return text;
}

std::string Scope::column_name(const Column& column) const {
  return request_.channels[column.channel].name.variable + column.part;
}

// The columns of the file, in the order in which the channels were asked for, whatever task they come from; `heading`
// gets their names.
Scope::Places Scope::places(std::vector<std::string>& heading) const {
  Places places;
  for (std::size_t c = 0; c < request_.channels.size(); ++c)
    for (std::size_t s = 0; s < streams_.size(); ++s)
      for (std::size_t k = 0; k < streams_[s].columns.size(); ++k) {
        if (streams_[s].columns[k].channel != c) continue;
        // Another task that produces the same variable, a successor, goes on in the same column.
        const std::string& unit = request_.channels[c].unit;
        const std::string name = column_name(streams_[s].columns[k]) + (unit == "1" ? "" : "(" + unit + ")");
        const auto known = std::find(heading.begin(), heading.end(), name);
        places[{s, k}] = static_cast<std::size_t>(known - heading.begin());
        if (known == heading.end()) heading.push_back(name);
      }
  return places;
}

std::string Scope::csv() const {
  std::vector<std::string> heading;
  const Places places = this->places(heading);
  std::map<std::int64_t, std::vector<std::pair<std::size_t, const Row*>>> instants;  // what streams published then
  for (std::size_t s = 0; s < streams_.size(); ++s)
    for (const Row& row : streams_[s].rows)
      if (!row.values.empty() && begin_ && row.at <= *begin_ + request_.duration)
        instants[row.at.count].emplace_back(s, &row);
  std::string text = "t(s)";
  for (const std::string& name : heading) text += "," + name;
  text += ",lost\n";
  std::vector<double> held(heading.size(), kNothing);
  char number[40];
  for (const auto& [at, rows] : instants) {
    std::uint64_t lost = 0;
    for (const auto& [s, row] : rows) {
      lost += row->lost;
      for (std::size_t k = 0; k < row->values.size(); ++k) held[places.at({s, k})] = row->values[k];
    }
    if (!is_in_window(Nanoseconds{at})) continue;
    std::snprintf(number, sizeof number, "%.9f", static_cast<double>(at - begin_->count) * 1e-9);
    text += number;
    for (const double value : held) {
      std::snprintf(number, sizeof number, "%.17g", value);
      text += std::isnan(value) ? std::string(",") : "," + std::string(number);
    }
    text += "," + std::to_string(lost) + "\n";
  }
  return text;
}

// The last value before the window holds from its left end. The last value in the window holds to its right end.
std::vector<draw::PlotPoint> Scope::points_of(const Stream& stream, std::size_t column) const {
  std::vector<draw::PlotPoint> points;
  const double left = seconds_between({}, {-request_.pre.count}), right = seconds_between({}, request_.duration);
  for (const Row& row : stream.rows) {
    const double value = column < row.values.size() ? row.values[column] : kNothing;
    const bool is_before = row.at < *begin_ - request_.pre;
    if (!is_before && !is_in_window(row.at)) continue;
    const double at = is_before ? left : seconds_between(*begin_, row.at);
    if (is_before) points.clear();
    if (row.is_break && !points.empty()) points.push_back({at, kNothing});
    points.push_back({at, value});
  }
  const bool holds_on = stream.newest >= *begin_ + request_.duration && stream.lost_after_window == 0;
  if (!points.empty() && holds_on && points.back().at < right) points.push_back({right, points.back().value});
  return points;
}

draw::Plot Scope::plot(const std::string& title, const std::string& note) const {
  draw::Plot plot;
  plot.title = title;
  plot.note = note;
  if (!begin_) return plot;
  if (request_.trigger) plot.mark = 0;
  for (std::size_t c = 0; c < request_.channels.size(); ++c)
    for (const Stream& stream : streams_)
      for (std::size_t k = 0; k < stream.columns.size(); ++k) {
        if (stream.columns[k].channel != c) continue;
        draw::Curve curve{column_name(stream.columns[k]), request_.channels[c].unit, points_of(stream, k), 0, true};
        if (request_.trigger && request_.trigger->channel().variable == request_.channels[c].name.variable)
          plot.level = request_.trigger->level(), plot.level_unit = curve.unit;
        const auto twin = std::ranges::find(plot.curves, curve.name, &draw::Curve::name);
        if (twin != plot.curves.end() && !is_drawn(*twin)) *twin = std::move(curve);
        else if (twin == plot.curves.end() || is_drawn(curve)) plot.curves.push_back(std::move(curve));
      }
  for (const Stream& stream : streams_) {
    std::optional<Nanoseconds> before;
    for (const Row& row : stream.rows) {
      if (!is_in_window(row.at)) continue;
      const Nanoseconds from = before.value_or(*begin_ - request_.pre);
      if (row.lost > 0)
        plot.gaps.push_back({seconds_between(*begin_, from), seconds_between(*begin_, row.at),
                             counted(row.lost, "row") + " of " + stream.task + " lost"});
      before = row.at;
    }
  }
  return plot;
}

}  // namespace chimera::cli
