// SPDX-License-Identifier: Apache-2.0
// Lays out the tables of `chimera top` for the size of the screen.
#include "chimera/cli/live/top.h"

#include <algorithm>
#include <cmath>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/columns.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/figures.h"
#include "chimera/cli/print/status_text.h"
#include "chimera/description/cpu_text.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

using LineLook = TopLine::Look;

constexpr std::size_t kNarrow = 80;

/// A task with everything that its line says.
struct Row {
  std::string name, state;
  double rate_hz = 0;
  std::int64_t mean_ns = 0, max_ns = 0, budget_ns = 0, jitter_ns = 0, missed = 0;
  bool has_missed_since = false, has_run = false;
  OldestInput oldest;
  double share = -1;    ///< of the capacity of its server; below 0: it has none
  std::string remarks;  ///< what seldom happens

  double used() const {
    if (share >= 0) return share;
    return budget_ns > 0 ? static_cast<double>(max_ns) / static_cast<double>(budget_ns) : 0;
  }
};

const Json& task_of(const Json& status, const std::string& name) {
  static const Json kNull;
  for (const Json& task : status["tasks"])
    if (text_of(task, "task") == name) return task;
  return kNull;
}

/// Execution time over time ON: of all of it, or of what lies between two looks.
double load_of(const Json& task, const Json& before) {
  const std::int64_t on = whole_of(task, "on_ns") - whole_of(before, "on_ns");
  const std::int64_t busy = whole_of(task, "busy_ns") - whole_of(before, "busy_ns");
  return on > 0 && busy >= 0 ? static_cast<double>(busy) / static_cast<double>(on) : 0;
}

std::string remarks_on(const Json& task) {
  std::string text = text_of(task, "standby_for");
  if (!text.empty()) text = "standby for " + text;
  constexpr std::pair<const char*, const char*> kSeldom[] = {
      {"demoted", "demoted"},   {"exhausted", "out of capacity"}, {"events_lost", "events lost"},
      {"partial", "partial"},   {"tolerated", "tolerated"},       {"preempted", "preempted"}};
  for (const auto& [key, word] : kSeldom)
    if (const std::int64_t n = whole_of(task, key); n > 0)
      append_joined(text, ", ", count_text(n) + " " + word);
  return text;
}

/// Adds the changes between two polls of the same incarnation of a task.
void add_recent(Row& row, const Json& task, const Json& before, double seconds) {
  const std::int64_t cycles = whole_of(task, "cycles"), earlier = whole_of(before, "cycles");
  if (!before.is_object() || seconds <= 0 || cycles < earlier ||
      whole_of(task, "incarnation") != whole_of(before, "incarnation"))
    return;
  row.has_missed_since = row.missed > whole_of(before, "missed") ||
                         whole_of(task, "demoted") > whole_of(before, "demoted") ||
                         whole_of(task, "events_lost") > whole_of(before, "events_lost");
  if (row.share >= 0) row.share = share_of_server(task["server"], load_of(task, before));
  row.rate_hz = static_cast<double>(cycles - earlier) / seconds;
  if (cycles == earlier) return;
  const double sum = static_cast<double>(row.mean_ns) * static_cast<double>(cycles) -
                     number_of(before["execution_ns"], "mean") * static_cast<double>(earlier);
  // Means are whole nanoseconds: after billions of cycles their difference may fall outside what is possible.
  row.mean_ns = std::clamp<std::int64_t>(std::llround(sum / static_cast<double>(cycles - earlier)), 0, row.max_ns);
}

std::vector<Row> rows_of(const Json& status, const Json& previous) {
  const double seconds = static_cast<double>(whole_of(status, "now_ns") - whole_of(previous, "now_ns")) * 1e-9;
  std::vector<Row> rows;
  for (const Json& task : status["tasks"]) {
    const Json& execution = task["execution_ns"];
    Row row{text_of(task, "task"), text_of(task, "state"), number_of(task, "rate_hz"), whole_of(execution, "mean"),
            whole_of(execution, "max"), whole_of(task, "budget_ns"), whole_of(task, "jitter_ns"),
            whole_of(task, "missed"), false, whole_of(task, "cycles") > 0, oldest_input(task), -1,
            remarks_on(task)};
    if (const Json& server = task["server"]; server.is_object()) {
      row.share = share_of_server(server, load_of(task, nullptr));
      row.budget_ns = whole_of(server, "capacity_ns");
    }
    add_recent(row, task, task_of(previous, row.name), previous.is_object() ? seconds : 0);
    if (row.state == "NOT-CREATED") row.state = "none";
    rows.push_back(std::move(row));
  }
  return rows;
}

void sort(std::vector<Row>& rows, TopOrder order) {
  const auto key = [order](const Row& row) -> double {
    switch (order) {
      case TopOrder::kExecution: return static_cast<double>(row.mean_ns);
      case TopOrder::kBudget: return row.used();
      case TopOrder::kJitter: return static_cast<double>(row.jitter_ns);
      case TopOrder::kMissed: return static_cast<double>(row.missed);
      case TopOrder::kAge: return row.oldest.variable.empty() ? -2 : row.oldest.age_ns < 0 ? 1e300
                                                                         : static_cast<double>(row.oldest.age_ns);
      default: return 0;
    }
  };
  if (order == TopOrder::kName)
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.name < b.name; });
  else if (order != TopOrder::kFile)
    std::stable_sort(rows.begin(), rows.end(), [&](const Row& a, const Row& b) { return key(a) > key(b); });
}

std::string or_dash(std::int64_t ns) { return ns == 0 ? "-" : duration_text(ns); }

/// Columns beyond 80 go to the name (a third, at most 20) and to the oldest input.
std::size_t name_width(std::size_t width) {
  return 12 + (width > kNarrow ? std::min<std::size_t>((width - kNarrow) / 3, 20) : 0);
}

/// True for a column that a screen of this width leaves out. The column of missed deadlines is never left out.
bool is_left_out(std::size_t column, std::size_t width) {
  constexpr std::size_t kBudget = 5, kJitter = 7, kRate = 2, kMean = 3;
  return (column == kBudget && width < kNarrow) || (column == kJitter && width < kNarrow - 8) ||
         (column == kRate && width < kNarrow - 16) || (column == kMean && width < kNarrow - 24);
}

std::string cells(const std::vector<std::string>& cell, std::size_t width) {
  constexpr std::size_t kWidths[] = {0, 5, 8, 7, 7, 7, 4, 7, 6};
  std::string line = fitted(cell[0], name_width(width));
  for (std::size_t i = 1; i < 9; ++i)
    if (!is_left_out(i, width)) line += " " + fitted(cell[i], kWidths[i], i > 1);
  return fitted(line + " " + cell[9], width);
}

TopLine task_line(const Row& row, std::size_t width) {
  const std::string used = row.budget_ns > 0 && row.has_run ? formatted("%.0f%%", 100 * row.used()) : "-";
  const bool is_wide = width >= kNarrow + 12;
  std::string input = row.oldest.variable.empty() ? "-"
                      : row.oldest.age_ns < 0     ? "never"
                                                  : duration_text(row.oldest.age_ns);
  if (is_wide && !row.oldest.variable.empty()) input = fitted(input, 9) + row.oldest.variable;
  if (is_wide && !row.remarks.empty()) input += "  " + row.remarks;
  TopLine line{cells({row.name, row.state, rate_text(row.rate_hz), or_dash(row.mean_ns), or_dash(row.max_ns),
                      or_dash(row.budget_ns), used, or_dash(row.jitter_ns), count_text(row.missed), input},
                     width)};
  if (row.state == "ERROR" || row.has_missed_since) line.look = LineLook::kAlarm;
  else if (row.state != "ON") line.look = LineLook::kFaint;
  return line;
}

TopLine rtpu_line(const Json& rtpu, std::size_t width) {
  const bool is_dead = !truth_at(rtpu, "alive") || truth_at(rtpu, "flag") || !text_of(rtpu, "hang").empty() ||
                       !text_of(rtpu, "lost_rights").empty();
  const std::string head = cpu_text(static_cast<std::uint32_t>(whole_of(rtpu, "cpu"))) + " " + text_of(rtpu, "policy") +
                           (text_of(rtpu, "executor") == "preemptive" ? " preemptive" : "") + "  ";
  return {fitted(head + rtpu_remarks(rtpu), width), is_dead ? LineLook::kAlarm : LineLook::kPlain};
}

/// Lines for tasks: what the headline, the rtpus, an empty line, the heading and the keys leave.
std::size_t room_for_tasks(const Json& status, const TopView& view) {
  const std::size_t taken = 4 + status["rtpus"].size();
  return view.height > taken ? view.height - taken : 0;
}

}  // namespace

std::optional<TopOrder> order_of_key(int key) {
  for (const TopOrder order : {TopOrder::kFile, TopOrder::kName, TopOrder::kExecution, TopOrder::kBudget,
                               TopOrder::kJitter, TopOrder::kMissed, TopOrder::kAge})
    if (key == static_cast<char>(order)) return order;
  return std::nullopt;
}

std::size_t most_skipped(const Json& status, const TopView& view) {
  const std::size_t tasks = status["tasks"].size(), room = room_for_tasks(status, view);
  return tasks > room ? tasks - room : 0;
}

std::vector<TopLine> help_lines(const TopView& view) {
  constexpr const char* kHelp[] = {
      "RATE    cycles in each second since the last update",
      "EXEC    mean execution time of a cycle since the last update; MAX: the longest so far",
      "USED    MAX as a part of BUDGET; above 100 % the stated budget is wrong",
      "JITTER  latest start minus earliest, each after its release",
      "MISSED  deadlines missed since the task was made, or its rtpu restarted",
      "INPUT   age of the oldest input; never: no task has written it",
      "red     in ERROR, or more missed since the last update; faint: not ON",
      "keys    q quits, h leaves this page; o n e b j m a sort; up and down move",
      "narrow  a screen below 80 columns leaves out BUDGET, then JITTER, RATE, EXEC"};
  std::vector<TopLine> lines;
  for (const char* text : kHelp) lines.push_back({fitted(text, view.width)});
  if (view.height == 0) return {};
  lines.resize(std::min(lines.size(), view.height - 1));
  while (lines.size() + 1 < view.height) lines.push_back({std::string(view.width, ' ')});
  lines.push_back({fitted("h back  q quit", view.width), LineLook::kFaint});
  return lines;
}

std::vector<TopLine> top_lines(const Json& status, const Json& previous, const TopView& view) {
  std::vector<TopLine> lines;
  const bool is_alarm = truth_at(status["flag"], "up") || truth_at(status, "ending");
  lines.push_back({fitted(headline(status), view.width), is_alarm ? LineLook::kAlarm : LineLook::kPlain});
  for (const Json& rtpu : status["rtpus"]) lines.push_back(rtpu_line(rtpu, view.width));
  lines.push_back({std::string(view.width, ' ')});
  lines.push_back({cells({"TASK", "STATE", "RATE", "EXEC", "MAX", "BUDGET", "USED", "JITTER", "MISSED", "INPUT"},
                         view.width),
                   LineLook::kHeading});
  std::vector<Row> rows = rows_of(status, previous);
  sort(rows, view.order);
  const std::size_t room = room_for_tasks(status, view), skipped = std::min(view.skipped, most_skipped(status, view));
  for (std::size_t i = skipped; i < rows.size() && i - skipped < room; ++i)
    lines.push_back(task_line(rows[i], view.width));
  if (view.height == 0) return {};
  lines.resize(std::min(lines.size(), view.height - 1));
  while (lines.size() + 1 < view.height) lines.push_back({std::string(view.width, ' ')});
  if (!view.has_keys) return lines;
  const std::size_t hidden = rows.size() - std::min(room, rows.size());
  std::string keys = "q quit  h help  sort: o order  n name  e exec  b used  j jitter  m missed  a age";
  if (hidden > 0) keys = std::to_string(hidden) + " more: up, down  q quit  h help  sort: o n e b j m a";
  lines.push_back({fitted(keys, view.width), LineLook::kFaint});
  return lines;
}

}  // namespace chimera::cli
