// SPDX-License-Identifier: Apache-2.0
// Judges a run by the rules of docs/decisions/0023-exit-code-of-a-run.md.
#include "chimera/cli/run/run_verdict.h"

#include <algorithm>
#include <cstdio>

#include "chimera/base/hosted/wording.h"
#include "chimera/platform/realtime.h"
#include "chimera/text/json_text.h"
#include "chimera/text/not_off.h"

namespace chimera::cli {
namespace {

/// Adds what `count` says of every task, with the tasks by name where it is not 0.
template <class Count>
std::uint64_t add_up(RunVerdict& verdict, std::span<const TaskProfile> tasks, const char* one, const char* many,
                     const Count& count) {
  std::uint64_t sum = 0;
  std::string who;
  for (const TaskProfile& task : tasks) {
    const std::uint64_t n = count(task);
    if (n > 0) append_joined(who, ", ", task.task + " " + std::to_string(n));
    sum += n;
  }
  if (sum > 0) verdict.remarks.push_back(counted(sum, one, many) + " (" + who + ")");
  return sum;
}

void add_not_off(RunVerdict& verdict, const std::string& task, const std::string& text) {
  verdict.failures.push_back(task + ": " + text);
  if (std::find(verdict.not_off.begin(), verdict.not_off.end(), task) == verdict.not_off.end())
    verdict.not_off.push_back(task);
}

/// `is_told`: tasks of it that were not turned off say how it ended.
void add_rtpu(RunVerdict& verdict, const RtpuFate& rtpu, bool is_told) {
  verdict.restarts += rtpu.restarts;
  if (rtpu.restarts > 0) {
    verdict.remarks.push_back(counted(rtpu.restarts, "restart", "restarts") + " of " + rtpu.name);
    verdict.since.push_back(rtpu.name + ": the counts of its tasks begin at its restart" +
                            (rtpu.restarted == kNever ? "" : " at " + seconds_text(rtpu.restarted) + " s"));
  }
  if (!rtpu.not_real_time.empty() && rtpu.not_real_time.find(kAskedWords) == std::string::npos)
    verdict.remarks.push_back(rtpu.name + " was not real time: " + rtpu.not_real_time);
  if (rtpu.died != kNever)
    verdict.remarks.push_back(rtpu.name + " died at " + seconds_text(rtpu.died) + " s and is not restarted");
  if (rtpu.is_given_up)
    verdict.failures.push_back(rtpu.name + " was given up: its process ended too often, its tasks did not run");
  if (!rtpu.bad_end.empty() && !is_told)
    verdict.failures.push_back(rtpu.name + " did not end in order: it " + rtpu.bad_end);
}

void add_end(RunVerdict& verdict, const TaskProfile& task, bool died_on_purpose, std::uint64_t faults_before) {
  const Method method = task.faults.method;
  const std::string fault = std::string(method_name(method)) + ": " + task.faults.last.text;
  const bool is_new = task.faults.count > faults_before;
  const bool is_told = std::find(verdict.not_off.begin(), verdict.not_off.end(), task.task) != verdict.not_off.end();
  if (task.state == State::kError && !died_on_purpose)
    verdict.failures.push_back(task.task + " was in ERROR at the end" + (task.faults.count > 0 ? ": " + fault : ""));
  else if (is_new && method == Method::kError)
    verdict.failures.push_back(task.task + " failed at the end: " + fault);
  if (is_told) return;
  if (task.faults.off_count > 0)
    add_not_off(verdict, task.task, not_off_text(task.faults.off_method, task.faults.off_text));
  else if (is_new && turns_off(method))
    add_not_off(verdict, task.task, not_off_text(method, task.faults.last.text));
}

}  // namespace

std::string seconds_text(Nanoseconds time) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f", to_seconds(time));
  return text;
}

std::string refused_line(Nanoseconds since_start, const std::string& what, const std::string& why) {
  return "refused at " + seconds_text(since_start) + " s: " + (what.empty() ? "" : what + ": ") + why + "\n";
}

RunVerdict judge_run(const RunFacts& facts) {
  RunVerdict verdict;
  verdict.is_strict = facts.is_strict;
  verdict.is_flag_up = facts.is_flag_up;
  verdict.missed = add_up(verdict, facts.tasks, "deadline missed", "deadlines missed", [](const TaskProfile& task) {
    return task.profile.missed - std::min(task.profile.missed, task.profile.tolerated);
  });
  verdict.dropped = add_up(verdict, facts.tasks, "release dropped", "releases dropped",
                           [](const TaskProfile& task) { return task.profile.dropped; });
  verdict.faults = add_up(verdict, facts.tasks, "fault", "faults",
                          [](const TaskProfile& task) { return std::uint64_t{task.faults.count}; });
  for (const NotOff& one : facts.not_off) add_not_off(verdict, one.task, one.text);
  for (const RtpuFate& rtpu : facts.rtpus) {
    const bool is_told = std::any_of(facts.tasks.begin(), facts.tasks.end(), [&](const TaskProfile& task) {
      return task.rtpu == rtpu.name && std::any_of(facts.not_off.begin(), facts.not_off.end(),
                                                   [&](const NotOff& one) { return one.task == task.task; });
    });
    add_rtpu(verdict, rtpu, is_told);
  }
  if (facts.is_flag_up) verdict.remarks.emplace_back("the illegal-configuration flag is up");
  for (std::size_t t = 0; t < facts.tasks.size(); ++t) {
    const bool died_on_purpose = std::any_of(facts.rtpus.begin(), facts.rtpus.end(), [&](const RtpuFate& rtpu) {
      return rtpu.died != kNever && rtpu.name == facts.tasks[t].rtpu;
    });
    add_end(verdict, facts.tasks[t], died_on_purpose, t < facts.faults_before.size() ? facts.faults_before[t] : 0);
  }
  return verdict;
}

std::string RunVerdict::text() const {
  std::string text;
  for (const std::string& line : since) text += line + "\n";
  if (is_clean())
    text += "clean: no deadline missed, no release dropped, no fault, no restart\n";
  else if (!remarks.empty())
    text += "not clean: " + join(remarks, ", ") + "\n";
  for (const std::string& failure : failures) text += "FAILED: " + failure + "\n";
  if (failures.empty() && is_failure()) text += "FAILED: not clean, and --strict makes that a failure\n";
  return text;
}

std::string RunVerdict::json() const {
  return spaced_json({{"clean", is_clean()},
                      {"strict", is_strict},
                      {"missed", missed},
                      {"dropped", dropped},
                      {"faults", faults},
                      {"restarts", restarts},
                      {"remarks", remarks},
                      {"since", since},
                      {"not_off", not_off},
                      {"failures", failures}});
}

}  // namespace chimera::cli
