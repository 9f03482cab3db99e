// SPDX-License-Identifier: Apache-2.0
// Writes the answers `status` and `profile` as tables.
#include "chimera/cli/print/status_text.h"

#include <algorithm>
#include <cstdio>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/columns.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/figures.h"
#include "chimera/description/cpu_text.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

std::string count_of(const Json& object, std::string_view key) { return count_text(whole_of(object, key)); }

/// A time of which 0 means that there is none.
std::string time_of(const Json& object, std::string_view key) {
  const std::int64_t ns = whole_of(object, key);
  return ns == 0 ? "-" : duration_text(ns);
}

std::string input_text(const Json& task) {
  const OldestInput oldest = oldest_input(task);
  if (oldest.age_ns >= 0) return duration_text(oldest.age_ns) + " " + oldest.variable;
  return oldest.variable.empty() ? "-" : "never " + oldest.variable;
}

std::string policy_of(const Json& rtpu) {
  return text_of(rtpu, "policy") + (text_of(rtpu, "executor") == "preemptive" ? " preemptive" : "");
}

std::string memory_text(std::int64_t bytes) {
  return bytes == 0 ? "-" : std::to_string(bytes / 1'000'000) + " MB";
}

std::string cpu_of(const Json& rtpu) {
  const auto cpu = static_cast<std::uint32_t>(whole_of(rtpu, "cpu"));
  return cpu < kFirstBoardCpu ? std::to_string(cpu) : "board";
}

Columns rtpu_table(const Json& status) {
  Columns table({"rtpu", ">cpu", "policy", "phase", ">pid", ">restarts", ">memory", "running", "flag"});
  for (const Json& rtpu : status["rtpus"])
    table.add({text_of(rtpu, "name"), cpu_of(rtpu), policy_of(rtpu), text_of(rtpu, "phase"),
               std::to_string(whole_of(rtpu, "pid")), std::to_string(whole_of(rtpu, "restarts")),
               memory_text(whole_of(rtpu, "resident_bytes")), or_dash(text_of(rtpu, "running")),
               truth_at(rtpu, "flag") ? "UP" : "-"});
  return table;
}

/// The keys among `keys` whose count is not zero in at least one task.
std::vector<std::string> that_count(const Json& answer, std::initializer_list<const char*> keys) {
  std::vector<std::string> found;
  for (const char* key : keys)
    for (const Json& task : answer["tasks"])
      if (whole_of(task, key) > 0) {
        found.emplace_back(key);
        break;
      }
  return found;
}

std::string percent(double part) { return formatted("%.2f %%", 100 * part); }

bool has_server(const Json& answer) {
  for (const Json& task : answer["tasks"])
    if (task["server"].is_object()) return true;
  return false;
}

/// "2.00 ms / 10.0 ms", and how much of that is used; both "-" without a server.
std::vector<std::string> server_cells(const Json& task, double load) {
  const Json& server = task["server"];
  if (!server.is_object()) return {"-", "-"};
  return {duration_text(whole_of(server, "capacity_ns")) + " / " + duration_text(whole_of(server, "period_ns")),
          percent(share_of_server(server, load))};
}

Columns task_table(const Json& status) {
  const auto seldom = that_count(status, {"partial", "tolerated", "preempted", "demoted", "events_lost", "exhausted"});
  std::vector<std::string> heading = {"task",  "state", "rtpu",    ">rate",   ">cycles",
                                      ">mean", ">max",  ">budget", ">jitter", ">missed"};
  const bool serves = has_server(status);
  if (serves) heading.insert(heading.end(), {">server", ">used"});
  for (const std::string& key : seldom) heading.push_back(">" + key);
  heading.insert(heading.end(), {">faults", "oldest input"});
  Columns table(std::move(heading));
  for (const Json& task : status["tasks"]) {
    const std::string primary = text_of(task, "standby_for");
    std::vector<std::string> row = {text_of(task, "task"),
                                    text_of(task, "state") + (primary.empty() ? "" : ", standby for " + primary),
                                    text_of(task, "rtpu"),
                                    rate_text(number_of(task, "rate_hz")),
                                    count_of(task, "cycles"),
                                    time_of(task["execution_ns"], "mean"),
                                    time_of(task["execution_ns"], "max"),
                                    time_of(task, "budget_ns"),
                                    time_of(task, "jitter_ns"),
                                    count_of(task, "missed")};
    const auto on = static_cast<double>(whole_of(task, "on_ns"));
    const double load = on > 0 ? number_of(task, "busy_ns") / on : 0;
    if (const auto cells = server_cells(task, load); serves) row.insert(row.end(), cells.begin(), cells.end());
    for (const std::string& key : seldom) row.push_back(count_of(task, key.c_str()));
    row.insert(row.end(), {count_of(task, "faults"), input_text(task)});
    table.add(std::move(row));
  }
  return table;
}

/// Execution time of the cycles as a part of the time that the task was ON; 0 before that.
double load_of(const Json& task) {
  const auto on = static_cast<double>(whole_of(task, "on_ns"));
  const Json& cycle = task["execution_ns"]["cycle"];
  return on <= 0 ? 0 : number_of(cycle, "mean") * static_cast<double>(whole_of(cycle, "count")) / on;
}

std::string load_text(const Json& task) {
  return whole_of(task["execution_ns"]["cycle"], "count") == 0 ? "-" : percent(load_of(task));
}

/// The counters of a table of tasks: some only where they say something.
std::vector<std::string> counters_of(const Json& answer) {
  std::vector<std::string> keys = {"missed", "overrun", "dropped", "stale", "rejected"};
  const auto seldom = that_count(answer, {"min_refused", "held", "aborted", "partial", "tolerated", "preempted",
                                          "demoted", "events", "events_lost", "exhausted"});
  keys.insert(keys.end(), seldom.begin(), seldom.end());
  keys.emplace_back("faults");
  return keys;
}

/// Every method but cycle that was called.
Columns method_table(const Json& answer) {
  Columns table({"task", "method", ">calls", ">mean", ">max"});
  for (const Json& task : answer["tasks"]) {
    const Json& methods = task["execution_ns"];
    if (!methods.is_object()) continue;
    for (const auto& [method, spread] : methods.items())
      if (method != "cycle" && whole_of(spread, "count") > 0)
        table.add({text_of(task, "task"), method, count_of(spread, "count"), duration_text(whole_of(spread, "mean")),
                   duration_text(whole_of(spread, "max"))});
  }
  return table;
}

Columns transfer_table(const Json& answer) {
  Columns table({"task", ">groups a cycle", ">bytes a cycle"});
  for (const Json& task : answer["tasks"])
    if (const Json& transfer = task["transfer"]; whole_of(transfer, "groups") > 0)
      table.add({text_of(task, "task"), count_of(transfer, "groups"), count_of(transfer, "bytes")});
  return table;
}

Columns unit_table(const Json& answer) {
  std::vector<std::string> names;
  for (const Json& task : answer["tasks"])
    if (const std::string name = text_of(task, "rtpu");
        !name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  const std::vector<std::string> counters = counters_of(answer);
  std::vector<std::string> heading = {"rtpu", ">tasks", ">load"};
  for (const std::string& key : counters) heading.push_back(">" + key);
  Columns table(std::move(heading));
  for (const std::string& name : names) {
    double load = 0;
    std::int64_t tasks = 0;
    std::vector<std::int64_t> sums(counters.size());
    for (const Json& task : answer["tasks"]) {
      if (text_of(task, "rtpu") != name) continue;
      ++tasks;
      load += load_of(task);
      for (std::size_t i = 0; i < counters.size(); ++i) sums[i] += whole_of(task, counters[i]);
    }
    std::vector<std::string> row = {name, count_text(tasks), percent(load)};
    for (const std::int64_t sum : sums) row.push_back(count_text(sum));
    table.add(std::move(row));
  }
  return table;
}

std::string with_space(const Columns& table) { return table.empty() ? "" : "\n" + table.text(); }

}  // namespace

std::string headline(const Json& status) {
  std::string line = text_of(status, "subsystem") + ": ";
  const std::string configuration = text_of(status, "configuration");
  line += configuration.empty() ? "no configuration" : configuration;
  const auto started = whole_or_none(status, "started_ns");
  line += started ? ", up " + duration_text(whole_of(status, "now_ns") - *started) : ", starting";
  return line + ", " + flag_words(status["flag"]) + (truth_at(status, "ending") ? ", ENDING" : "") +
         (text_of(status["face"], "lost_output").empty() ? "" : ", OUTPUT LOST");
}

/// Lines about the run client, the process that prints the run; "" when nothing happened to it.
static std::string face_text(const Json& face) {
  std::string text;
  if (const std::string lost = text_of(face, "lost_output"); !lost.empty())
    text += "standard output of the run is lost: " + lost + "\n";
  if (const std::int64_t deaths = whole_of(face, "deaths"); deaths > 0)
    text += "the process that prints and ends the run was replaced " + counted(deaths, "time") +
            "; last end: " + text_of(face, "last_end") + "\n";
  return text;
}

std::string flag_words(const Json& flag) {
  const std::string by = join(texts_of(flag, "by"), ", ");
  return (truth_at(flag, "up") ? "flag UP" : "flag down") + (by.empty() ? by : " by " + by);
}

double share_of_server(const Json& server, double load) {
  const auto capacity = static_cast<double>(whole_of(server, "capacity_ns"));
  return capacity <= 0 ? 0 : load * static_cast<double>(whole_of(server, "period_ns")) / capacity;
}

std::string rtpu_remarks(const Json& rtpu) {
  std::string line = text_of(rtpu, "name") + " " +
                     (truth_at(rtpu, "alive") || !text_of(rtpu, "hang").empty() ? text_of(rtpu, "phase")
                      : truth_at(rtpu, "given_up")                              ? "GIVEN UP"
                                                                                : "DEAD");
  if (const std::int64_t n = whole_of(rtpu, "restarts"); n > 0)
    line += ", restarted " + (n == 1 ? std::string("once") : std::to_string(n) + " times");
  if (const std::string running = text_of(rtpu, "running"); !running.empty()) line += ", running " + running;
  if (const std::string hang = text_of(rtpu, "hang"); !hang.empty()) line += ", HANGS: " + hang;
  if (truth_at(rtpu, "flag")) line += ", FLAG";
  if (const std::int64_t bytes = whole_of(rtpu, "resident_bytes"); bytes > 0) line += ", " + memory_text(bytes);
  if (const std::string lost = text_of(rtpu, "lost_rights"); !lost.empty()) line += ", RIGHTS LOST: " + lost;
  if (!text_of(rtpu, "not_real_time").empty()) line += ", NOT REAL TIME";
  if (const std::int64_t lost = whole_of(rtpu, "lost_events"); lost > 0)
    line += ", " + std::to_string(lost) + " events lost";
  if (const std::string end = text_of(rtpu, "last_end"); !end.empty()) line += "; last end: " + end;
  return line;
}

OldestInput oldest_input(const Json& task) {
  OldestInput oldest;
  for (const Json& input : task["inputs"]) {
    const auto age = whole_or_none(input, "age_ns");
    if (!age) return {-1, text_of(input, "variable")};  // never written is older than any age
    if (*age > std::max<std::int64_t>(oldest.age_ns, 0)) oldest = {*age, text_of(input, "variable")};
  }
  return oldest;
}

std::string status_text(const Json& status) {
  std::string text = headline(status) + "\n" + face_text(status["face"]);
  if (const Columns rtpus = rtpu_table(status); !rtpus.empty()) text += "\n" + rtpus.text();
  for (const char* process : {"keeper", "guard"})
    if (const std::string hang = text_of(status[process], "hang"); !hang.empty())
      text += process + (": HANGS: " + hang) + "\n";
  if (const std::string lack = text_of(status["guard"], "lack"); !lack.empty()) text += lack + "\n";
  for (const Json& rtpu : status["rtpus"])
    if (const std::string why = text_of(rtpu, "unguarded"); !why.empty())
      text += text_of(rtpu, "name") + ": NO GUARD: " + why + "\n";
  for (const Json& rtpu : status["rtpus"])
    if (const std::string hang = text_of(rtpu, "hang"); !hang.empty())
      text += text_of(rtpu, "name") + ": HANGS: " + hang + "\n";
  for (const Json& rtpu : status["rtpus"])
    if (const std::string end = text_of(rtpu, "last_end"); !end.empty())
      text += text_of(rtpu, "name") + ": " + (truth_at(rtpu, "given_up") ? "GIVEN UP; " : "") + "last end: " + end +
              (whole_of(rtpu, "restarts") > 0 ? "; its tasks count from their restart" : "") +
              (text_of(rtpu, "remedy").empty() ? "" : "\n  to bring it back type " + text_of(rtpu, "remedy")) + "\n";
  for (const Json& rtpu : status["rtpus"])
    if (const std::string lost = text_of(rtpu, "lost_rights"); !lost.empty())
      text += text_of(rtpu, "name") + ": RIGHTS LOST: " + lost + "\n";
  for (const Json& rtpu : status["rtpus"])
    if (const std::string why = text_of(rtpu, "not_real_time"); !why.empty())
      text += text_of(rtpu, "name") + ": NOT REAL TIME: " + why + "\n";
  if (const Columns tasks = task_table(status); !tasks.empty()) text += "\n" + tasks.text();
  for (const Json& task : status["tasks"])
    if (const std::string fault = text_of(task, "fault"); !fault.empty())
      text += text_of(task, "task") + ": last fault: " + fault + "\n";
  return text;
}

std::string profile_text(const Json& answer) {
  const std::vector<std::string> counters = counters_of(answer);
  std::vector<std::string> heading = {"task", "state", ">cycles", ">mean", ">max", ">load", ">response", ">jitter"};
  const bool serves = has_server(answer);
  if (serves) heading.insert(heading.end(), {">server", ">used"});
  for (const std::string& key : counters) heading.push_back(">" + key);
  Columns table(std::move(heading));
  std::string faults;
  for (const Json& task : answer["tasks"]) {
    const Json& cycle = task["execution_ns"]["cycle"];
    const Json& delay = task["start_delay_ns"];
    const bool has_delay = whole_of(delay, "count") > 0;
    std::vector<std::string> row = {text_of(task, "task"),
                                    text_of(task, "state"),
                                    count_of(task, "cycles"),
                                    time_of(cycle, "mean"),
                                    time_of(cycle, "max"),
                                    load_text(task),
                                    time_of(task["response_ns"], "max"),
                                    has_delay ? duration_text(whole_of(delay, "max") - whole_of(delay, "min")) : "-"};
    if (const auto cells = server_cells(task, load_of(task)); serves) row.insert(row.end(), cells.begin(), cells.end());
    for (const std::string& key : counters) row.push_back(count_of(task, key));
    table.add(std::move(row));
    const Json& fault = task["last_fault"];
    if (fault.is_object())
      faults += text_of(task, "task") + ": last fault in " + text_of(fault, "method") + " at " +
                duration_text(whole_of(fault, "at_ns")) + ": " + text_of(fault, "text") + "\n";
  }
  return table.text() + faults + with_space(method_table(answer)) + with_space(transfer_table(answer)) +
         with_space(unit_table(answer));
}

}  // namespace chimera::cli
