// SPDX-License-Identifier: Apache-2.0
// Writes the profiles of tasks as a table.
#include "chimera/cli/run/profile_report.h"

#include <algorithm>
#include <cstdio>

#include "chimera/base/hosted/wording.h"

namespace chimera::cli {
namespace {

std::string spread_text(Nanoseconds t) {
  const double us = static_cast<double>(t.count) * 1e-3;
  if (us < 1000) return formatted("%.1f us", us);
  return us < 1e6 ? formatted("%.2f ms", us * 1e-3) : formatted("%.2f s", us * 1e-6);
}

std::string max_text(const Spread& spread) { return spread.count == 0 ? "-" : spread_text(spread.max); }
std::string mean_text(const Spread& spread) { return spread.count == 0 ? "-" : spread_text(spread.mean()); }
std::string jitter_text(const Spread& spread) { return spread.count == 0 ? "-" : spread_text(spread.max - spread.min); }

/// A count that is printed only where it is not zero.
struct Seldom {
  const char* name;
  std::uint64_t Profile::* count;
};
constexpr Seldom kSeldom[] = {{"over budget", &Profile::overrun},
                              {"without time for 'min'", &Profile::min_refused},
                              {"held", &Profile::held},
                              {"aborted", &Profile::aborted},
                              {"partial", &Profile::partial},
                              {"tolerated", &Profile::tolerated},
                              {"preempted", &Profile::preempted},
                              {"demoted", &Profile::demoted},
                              {"events", &Profile::events},
                              {"events lost", &Profile::events_lost},
                              {"times out of capacity", &Profile::exhausted}};

/// "pid: 12 preempted, 1 demoted", or nothing.
std::string seldom_line(const TaskProfile& task) {
  std::string text;
  const auto add = [&text](std::uint64_t n, const char* name) {
    if (n > 0) append_joined(text, ", ", std::to_string(n) + " " + name);
  };
  for (const Seldom& kind : kSeldom) add(task.profile.*kind.count, kind.name);
  add(task.profile.restarts, task.profile.restarts == 1 ? "restart" : "restarts");
  add(task.profile.takeovers, task.profile.takeovers == 1 ? "takeover" : "takeovers");
  return text.empty() ? "" : task.task + ": " + text + "\n";
}

std::string row(const TaskProfile& task, Nanoseconds ran, int width) {
  const Profile& p = task.profile;
  const Spread& cycle = p.execution[CHIMERA_CYCLE];
  const double load = ran.count > 0 ? static_cast<double>(cycle.sum.count) / static_cast<double>(ran.count) : 0;
  char line[400];
  std::snprintf(line, sizeof line, "%-*.*s  %-11s %9llu  %10s %10s  %6.2f %%  %10s  %10s  %6llu %6llu %6llu\n", width,
                static_cast<int>(task.task.size()), task.task.data(), state_name(task.state),
                static_cast<unsigned long long>(p.cycles), mean_text(cycle).c_str(), max_text(cycle).c_str(),
                100 * load, max_text(p.response).c_str(), jitter_text(p.start_delay).c_str(),
                static_cast<unsigned long long>(p.missed), static_cast<unsigned long long>(p.dropped),
                static_cast<unsigned long long>(task.faults.count));
  return line;
}

}  // namespace

std::vector<TaskProfile> profiles_of(std::span<const Task* const> tasks, std::span<const State> states,
                                     const Configuration& configuration, Nanoseconds now) {
  const auto rtpus = configuration.rtpus();
  std::vector<TaskProfile> profiles;
  for (const Task* task : tasks)
    profiles.push_back({std::string(task->spec->name), std::string(task->spec->component), states[task->id.index],
                        task->spec->period, task->profile, task->faults,
                        std::string(rtpus[task->spec->rtpu.index].name), transfer_of(configuration, task->id.index),
                        task->profile.on_by(now), task->spec->server});
  return profiles;
}

std::string profile_table(std::span<const TaskProfile> tasks, Nanoseconds ran, Nanoseconds origin) {
  std::size_t width = 4;
  for (const TaskProfile& task : tasks) width = std::max(width, task.task.size());
  const int w = static_cast<int>(width);
  char head[400];
  std::snprintf(head, sizeof head, "%-*s  %-11s %9s  %10s %10s  %8s  %10s  %10s  %6s %6s %6s\n", w, "task", "state",
                "cycles", "mean", "max", "load", "response", "jitter", "missed", "dropped", "faults");
  std::string text = head;
  for (const TaskProfile& task : tasks) text += row(task, ran, w);
  for (const TaskProfile& task : tasks) text += seldom_line(task);
  for (const TaskProfile& task : tasks)
    if (task.faults.count > 0)
      text += task.task + ": last fault in " + method_name(task.faults.method) + " at " +
              spread_text(task.faults.at - origin) + ": " + task.faults.last.text + "\n";
  return text;
}

}  // namespace chimera::cli
