// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/profile_report.h"

#include <algorithm>
#include <cstdio>

#include "chimera/desk/output.h"

namespace chimera::desk {
namespace {

std::string time_text(Nanoseconds t) {
  char text[32];
  const double us = static_cast<double>(t.count) * 1e-3;
  if (us < 1000) std::snprintf(text, sizeof text, "%.1f us", us);
  else if (us < 1e6) std::snprintf(text, sizeof text, "%.2f ms", us * 1e-3);
  else std::snprintf(text, sizeof text, "%.2f s", us * 1e-6);
  return text;
}

std::string max_text(const Spread& spread) { return spread.count == 0 ? "-" : time_text(spread.max); }
std::string mean_text(const Spread& spread) { return spread.count == 0 ? "-" : time_text(spread.mean()); }
std::string jitter_text(const Spread& spread) { return spread.count == 0 ? "-" : time_text(spread.max - spread.min); }

std::string row(const Task& task, State state, Nanoseconds ran, int width) {
  const Profile& p = task.profile;
  const Spread& cycle = p.execution[CHIMERA_CYCLE];
  const double load = ran.count > 0 ? static_cast<double>(cycle.sum.count) / static_cast<double>(ran.count) : 0;
  char line[400];
  std::snprintf(line, sizeof line, "%-*.*s  %-11s %9llu  %10s %10s  %6.2f %%  %10s  %10s  %6llu %6llu %6llu\n", width,
                static_cast<int>(task.spec->name.size()), task.spec->name.data(), state_name(state),
                static_cast<unsigned long long>(p.cycles), mean_text(cycle).c_str(), max_text(cycle).c_str(),
                100 * load, max_text(p.response).c_str(), jitter_text(p.start_delay).c_str(),
                static_cast<unsigned long long>(p.missed), static_cast<unsigned long long>(p.dropped),
                static_cast<unsigned long long>(task.faults.count));
  return line;
}

std::string number(std::uint64_t n) { return std::to_string(n); }

std::string spread_json(const Spread& spread) {
  if (spread.count == 0) return "{\"count\": 0}";
  return "{\"count\": " + number(spread.count) + ", \"min\": " + std::to_string(spread.min.count) +
         ", \"mean\": " + std::to_string(spread.mean().count) + ", \"max\": " + std::to_string(spread.max.count) + "}";
}

std::string task_json(const Task& task, State state, Nanoseconds origin) {
  const Profile& p = task.profile;
  std::string methods;
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m)
    if (p.execution[m].count > 0)
      methods += (methods.empty() ? "" : ", ") + json_string(method_name(static_cast<Method>(m))) + ": " +
                 spread_json(p.execution[m]);
  std::string text =
      "{\"task\": " + json_string(task.spec->name) + ", \"component\": " + json_string(task.spec->component) +
      ", \"state\": " + json_string(state_name(state)) + ", \"period_ns\": " + std::to_string(task.spec->period.count) +
      ", \"cycles\": " + number(p.cycles) + ", \"execution_ns\": {" + methods +
      "}, \"response_ns\": " + spread_json(p.response) + ", \"start_delay_ns\": " + spread_json(p.start_delay) +
      ", \"missed\": " + number(p.missed) + ", \"overrun\": " + number(p.overrun) +
      ", \"min_refused\": " + number(p.min_refused) + ", \"dropped\": " + number(p.dropped) +
      ", \"held\": " + number(p.held) + ", \"aborted\": " + number(p.aborted) + ", \"stale\": " + number(p.stale) +
      ", \"rejected\": " + number(p.rejected) + ", \"faults\": " + number(task.faults.count);
  if (task.faults.count > 0)
    text += ", \"last_fault\": {\"method\": " + json_string(method_name(task.faults.method)) +
            ", \"at_ns\": " + std::to_string((task.faults.at - origin).count) +
            ", \"code\": " + std::to_string(task.faults.last.code) +
            ", \"text\": " + json_string(task.faults.last.text) + "}";
  return text + "}";
}

}  // namespace

std::vector<State> states_of(const TaskSet& tasks) {
  std::vector<State> states;
  for (const Task& task : tasks.tasks()) states.push_back(task.state);
  return states;
}

std::string profile_table(const TaskSet& tasks, std::span<const State> states, Nanoseconds ran, Nanoseconds origin) {
  std::size_t width = 4;
  for (const Task& task : tasks.tasks()) width = std::max(width, task.spec->name.size());
  const int w = static_cast<int>(width);
  char head[400];
  std::snprintf(head, sizeof head, "%-*s  %-11s %9s  %10s %10s  %8s  %10s  %10s  %6s %6s %6s\n", w, "task", "state",
                "cycles", "mean", "max", "load", "response", "jitter", "missed", "dropped", "faults");
  std::string text = head;
  for (const Task& task : tasks.tasks()) text += row(task, states[task.id.index], ran, w);
  for (const Task& task : tasks.tasks())
    if (task.faults.count > 0)
      text += std::string(task.spec->name) + ": last fault in " + method_name(task.faults.method) + " at " +
              time_text(task.faults.at - origin) + ": " + task.faults.last.text + "\n";
  return text;
}

std::string profile_json(const TaskSet& tasks, std::span<const State> states, Nanoseconds origin) {
  std::string rows;
  for (const Task& task : tasks.tasks())
    rows += (rows.empty() ? "" : ", ") + task_json(task, states[task.id.index], origin);
  return "[" + rows + "]";
}

}  // namespace chimera::desk
