// SPDX-License-Identifier: Apache-2.0
// Writes the outcome of a sweep as a table, JSON, CSV or a plot.
#include "chimera/cli/batch/sweep_table.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/text/json_text.h"

namespace chimera::cli {
namespace {

constexpr std::size_t kMostCurves = 24;  // more cannot be distinguished

struct Column {
  std::string name, unit;
};

using Cells = std::vector<std::string>;

std::string headed(const std::string& name, const std::string& unit) {
  return unit.empty() || unit == "1" ? name : name + " [" + unit + "]";
}

/// Every number that any run has measured: the runs may differ in extents.
std::vector<Column> columns(const SweepTable& table) {
  std::vector<Column> all;
  for (const MeasuredRun& run : table.runs)
    for (const Measure::Number& number : run.numbers)
      if (std::none_of(all.begin(), all.end(), [&](const Column& known) { return known.name == number.name; }))
        all.push_back({number.name, number.unit});
  return all;
}

const Measure::Number* number_of(const MeasuredRun& run, const std::string& name) {
  for (const Measure::Number& number : run.numbers)
    if (number.name == name) return &number;
  return nullptr;
}

std::string failure_of(const MeasuredRun& run) { return run.failure.empty() ? "" : "FAILED: " + run.failure; }

Cells head(const SweepTable& table) {
  Cells cells;
  for (const ValueList& list : table.lists) cells.push_back(headed(list.name, list.unit));
  for (const Column& column : columns(table)) cells.push_back(headed(column.name, column.unit));
  for (const std::string& text : table.expectations) cells.push_back(text);
  return cells;
}

/// `nothing` stands for what has no value.
Cells row(const SweepTable& table, std::size_t r, const std::vector<Column>& columns, bool exact,
          const std::string& nothing) {
  const MeasuredRun& run = table.runs[r];
  Cells cells;
  for (std::size_t l = 0; l < table.lists.size(); ++l) cells.push_back(table.lists[l].shown[table.index_of(r, l)]);
  for (const Column& column : columns) {
    const Measure::Number* number = run.failure.empty() ? number_of(run, column.name) : nullptr;
    if (number == nullptr || !number->value)
      cells.push_back(nothing);
    else
      cells.push_back(exact ? json_number(*number->value) : formatted("%.6g", *number->value));
  }
  for (std::size_t e = 0; e < table.expectations.size(); ++e)
    cells.push_back(!run.failure.empty() ? nothing : run.expectations[e].holds ? "holds" : "FAILS");
  return cells;
}

std::string csv_cell(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string line_of(const Cells& cells, const std::vector<std::size_t>& widths, const std::string& failure) {
  const std::string line = join_n(cells.size(), "  ", [&](std::size_t i) {
    return std::string(widths[i] - std::min(widths[i], cells[i].size()), ' ') + cells[i];
  });
  return line + (failure.empty() ? "" : "  " + failure) + "\n";
}

/// "kp = 2 N.m/rad, ki = 0" of all lists but the first.
std::string others(const SweepTable& table, std::size_t run) {
  std::string text;
  for (std::size_t l = 1; l < table.lists.size(); ++l)
    text += ", " + table.lists[l].name + " = " + table.lists[l].values[table.index_of(run, l)];
  return text;
}

Json json_of(const SweepTable& table, std::size_t r) {
  const MeasuredRun& run = table.runs[r];
  Json set = Json::object(), values = Json::object(), expectations = Json::array();
  for (std::size_t l = 0; l < table.lists.size(); ++l)
    set[table.lists[l].name] = table.lists[l].values[table.index_of(r, l)];
  for (const Measure::Number& number : run.numbers)
    values[number.name] = {{"unit", number.unit}, {"value", number.value ? Json(*number.value) : Json()}};
  for (const RunReport::Judged& judged : run.expectations)
    expectations.push_back({{"text", judged.text}, {"holds", judged.holds}, {"said", judged.said}});
  return {{"set", std::move(set)},
          {"failure", run.failure.empty() ? Json() : Json(run.failure)},
          {"values", std::move(values)},
          {"expectations", std::move(expectations)}};
}

}  // namespace

std::size_t SweepTable::index_of(std::size_t run, std::size_t list) const {
  for (std::size_t l = lists.size(); --l > list;) run /= lists[l].values.size();
  return run % lists[list].values.size();
}

bool SweepTable::is_good() const {
  return std::all_of(runs.begin(), runs.end(), [](const MeasuredRun& run) {
    return run.failure.empty() && std::all_of(run.expectations.begin(), run.expectations.end(),
                                              [](const RunReport::Judged& judged) { return judged.holds; });
  });
}

std::string text(const SweepTable& table) {
  const std::vector<Column> known = columns(table);
  std::vector<Cells> lines = {head(table)};
  for (std::size_t r = 0; r < table.runs.size(); ++r) lines.push_back(row(table, r, known, false, "-"));
  std::vector<std::size_t> widths(lines[0].size());
  for (const Cells& cells : lines)
    for (std::size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], cells[i].size());
  std::string all = line_of(lines[0], widths, "");
  for (std::size_t r = 0; r < table.runs.size(); ++r) all += line_of(lines[r + 1], widths, failure_of(table.runs[r]));
  return all;
}

std::string csv(const SweepTable& table) {
  const std::vector<Column> known = columns(table);
  const auto line = [](const Cells& cells) { return join(cells, ",", csv_cell) + "\n"; };
  Cells cells = head(table);
  cells.emplace_back("failure");
  std::string all = line(cells);
  for (std::size_t r = 0; r < table.runs.size(); ++r) {
    cells = row(table, r, known, true, "");
    cells.push_back(table.runs[r].failure);
    all += line(cells);
  }
  return all;
}

std::string json(const SweepTable& table) {
  const auto row = [&table](std::size_t r) { return spaced_json(json_of(table, r)); };
  const std::string rows = join_n(table.runs.size(), ",\n", row);
  return "{\"subsystem\": " + json_string(table.subsystem) + ", \"runs\": [\n" + rows + "]}\n";
}

draw::Plot plot(const SweepTable& table) {
  draw::Plot made;
  const ValueList& first = table.lists[0];
  const bool has_numbers = !first.numbers.empty();
  made.title = table.subsystem;
  made.across = has_numbers ? headed(first.name, first.unit) : first.name + " (number of the value, from 1)";
  const std::size_t combinations = table.runs.size() / first.values.size();
  std::size_t wanted = 0, failed = 0;
  for (const Column& column : columns(table))
    for (std::size_t c = 0; c < combinations; ++c, ++wanted) {
      if (made.curves.size() >= kMostCurves) continue;
      draw::Curve curve{column.name + others(table, c), column.unit, {}};
      curve.has_marks = true;
      for (std::size_t v = 0; v < first.values.size(); ++v) {
        const MeasuredRun& run = table.runs[v * combinations + c];
        const Measure::Number* number = run.failure.empty() ? number_of(run, column.name) : nullptr;
        if (number == nullptr || !number->value) continue;
        curve.points.push_back({has_numbers ? first.numbers[v] : static_cast<double>(v + 1), *number->value});
      }
      std::stable_sort(curve.points.begin(), curve.points.end(),
                       [](const draw::PlotPoint& a, const draw::PlotPoint& b) { return a.at < b.at; });
      made.curves.push_back(std::move(curve));
    }
  for (const MeasuredRun& run : table.runs) failed += run.failure.empty() ? 0 : 1;
  if (failed > 0) made.note = std::to_string(failed) + " of " + std::to_string(table.runs.size()) + " runs failed";
  if (wanted > kMostCurves)
    append_joined(made.note, "; ",
                  "the first " + std::to_string(kMostCurves) + " of " + std::to_string(wanted) + " curves");
  return made;
}

}  // namespace chimera::cli
