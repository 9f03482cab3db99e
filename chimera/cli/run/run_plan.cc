// SPDX-License-Identifier: Apache-2.0
// Checks the words of `chimera run` against the description and decides which executor runs it.
#include "chimera/cli/run/run_plan.h"

#include <algorithm>

#include "chimera/analysis/schedule_report.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/cli/files/check.h"
#include "chimera/cli/run/run.h"
#include "chimera/cli/run/script_text.h"
#include "chimera/platform/realtime.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/runtime/hosted/together.h"
#include "chimera/schedule/utilisation.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/setting.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {
namespace {

constexpr double kUsualRealtimeShare = 0.95;

Executor executor_of(const RunRequest& request) {
  if (request.virtual_time) return request.preemptive ? Executor::kPreemptiveVirtual : Executor::kVirtual;
  return request.one_process ? Executor::kOneProcess : Executor::kProcesses;
}

Result<void> judge_task_names(const RunRequest& request, const Configuration& configuration) {
  const auto names = names_of(configuration.tasks(), &ConfiguredTask::name);
  for (const std::string& name : request.may_miss)
    if (std::ranges::find(names, name) == names.end())
      return Error{ErrorCode::kNotFound, {"--may-miss: " + no_such("task", name, names)}, {}};
  return {};
}

/// Real time only: refuses tasks that must keep their deadlines but may miss them, by the schedulability analysis.
Report promises(const RunRequest& request, const Configuration& configuration) {
  if (request.virtual_time) return Report(configuration.file());
  ScheduleOptions options;
  options.may_miss = request.may_miss;
  options.one_rtpu = request.one_process;
  return unschedulable(configuration, schedule_report(configuration, options));
}

/// Refuses a load above the share that the kernel leaves to real-time threads. The share is reduced by the margin of
/// kMaxUtilisation below the usual 0.95.
Result<void> judge_throttling(const RunRequest& request, const Configuration& configuration) {
  if (request.virtual_time || request.priority == 0 || !may_be_realtime(request.priority)) return {};
  return admit_below(configuration, realtime_share());
}

/// A list is as long as the one before it where its length is a constant that only `init` may know.
bool is_as_long(const GivenSpec& now, const GivenSpec& before) {
  for (std::size_t d = 0; d < CHIMERA_MAX_EXTENTS; ++d)
    if (now.extent[d].constant.is_valid() && now.listed[d] != 0 && now.listed[d] != before.listed[d]) return false;
  return true;
}

/// The act with its bytes, judged by the rules of the description.
Result<ScriptAct> settled(const TimedAct& timed, RunPlan& plan) {
  const std::string said = "--at '" + timed.text + "'";
  const ConfiguredVariable* constant = nullptr;
  for (const ConfiguredVariable& known : plan.configuration.variables())
    if (known.is_constant && known.name == timed.variable) constant = &known;
  if (constant != nullptr || timed.variable.find('.') != std::string::npos)
    return Error{ErrorCode::kRefused,
                 {said + ": '" + timed.variable +
                  "' is a constant, which nothing changes while tasks run; for the "
                  "whole run: --set " +
                  timed.variable + " VALUE"},
                 {plan.configuration.file()}};
  auto set = with_new_value(plan.configuration, plan.library, {timed.variable, timed.value, said});
  if (!set) return set.error();
  ScriptAct act = timed.act;
  const auto operators = set->spec().operators;
  while (operators[act.operator_index].name != timed.variable) ++act.operator_index;
  act.value = operators[act.operator_index].value;
  if (!is_as_long(operators[act.operator_index], plan.configuration.spec().operators[act.operator_index]))
    return Error{ErrorCode::kBadInput,
                 {said + ": the list is not as long as the one that '" + timed.variable + "' begins with"},
                 {plan.configuration.file()}};
  plan.set.push_back(*std::move(set));
  return act;
}

/// Why the act cannot be done in this run; "": it can.
std::string why_not(const ScriptAct& act, const RunRequest& request, const Configuration& configuration) {
  const bool has_rtpus = request.virtual_time && are_on_several_rtpus(configuration);
  if (act.at > request.duration) return "it comes after the end of the run, which --for gives";
  if (act.kind != ScriptAct::Kind::kDie) return {};
  if (!has_rtpus) return "an rtpu dies in virtual time only (--virtual), where tasks are on several rtpus";
  const auto tasks = configuration.tasks();
  const bool is_there = std::any_of(tasks.begin(), tasks.end(),
                                    [&](const ConfiguredTask& task) { return task.rtpu == act.rtpu.index; });
  return is_there ? "" : "no task is on that rtpu";
}

/// An expectation of the value at the end, or of a measure of the whole run, as in a file of cases.
Result<void> add_expectation(const std::string& text, RunPlan& plan) {
  const auto& units = plan.library.units();
  auto measure = Measure::parse_expectation(text, plan.configuration, units);
  const bool has_words = trimmed(text.substr(0, text.find_first_of("<>"))).find_first_of(" [.") != std::string::npos;
  if (!has_words || (measure && measure->is_end_of_variable())) {
    auto expectation = Expectation::parse(text, plan.configuration, units);
    if (!expectation) return expectation.error();
    plan.bounds.push_back(expectation->bound());
    plan.expectations.push_back(*std::move(expectation));
    return {};
  }
  if (!measure) return Error{ErrorCode::kBadInput, {std::string("--expect ") + measure.error().message.c_str()}, {}};
  plan.bounds.push_back(measure->bound());
  plan.measures.push_back(*std::move(measure));
  return {};
}

Result<void> judge_words(const RunRequest& request, RunPlan& plan) {
  for (const std::string& name : request.watch)
    if (auto found = find_variable(plan.configuration, name); !found) return found.error();
  for (const std::string& text : request.expect)
    if (auto added = add_expectation(text, plan); !added) return added;
  if (auto known = judge_task_names(request, plan.configuration); !known) return known.error();
  return judge_acts(request, plan);
}

}  // namespace

Result<void> judge_acts(const RunRequest& request, RunPlan& plan) {
  const auto acts = parse_script(request.at, plan.configuration.spec());
  if (!acts) return acts.error();
  for (const TimedAct& timed : *acts) {
    const bool is_set = timed.act.kind == ScriptAct::Kind::kSet;
    const std::string why = why_not(timed.act, request, plan.configuration);
    if (!why.empty())
      return Error{ErrorCode::kRefused, {"--at '" + timed.text + "': " + why}, {plan.configuration.file()}};
    const auto act = is_set ? settled(timed, plan) : Result<ScriptAct>(timed.act);
    if (!act) return act.error();
    plan.acts.push_back(*act);
    if (!timed.has_lists()) continue;
    plan.acts.back().lists = &plan.lists.emplace_back(timed.lists);
  }
  return {};
}

Nanoseconds sample_distance(Nanoseconds every, Nanoseconds duration, const ApplicationSpec& spec) {
  constexpr std::int64_t kMostSamples = 1'000'000;
  if (every.count <= 0) {
    every = kNever;
    for (const TaskId task : spec.start)
      if (!spec.tasks[task.index].aperiodic) every = std::min(every, spec.tasks[task.index].period);
    if (every == kNever) every = milliseconds(1);
  }
  return std::max(every, Nanoseconds{duration.count / kMostSamples + 1});
}

Result<void> admit_below(const Configuration& configuration, double share) {
  const double limit = share - (kUsualRealtimeShare - kMaxUtilisation);
  for (const ConfiguredSet& set : configuration.sets()) {
    const auto excess = excess_of(configuration.spec(), set.order, limit);
    if (!excess) continue;
    const bool is_start = &set == &configuration.sets()[configuration.start()];
    const std::string of = is_start ? "" : " of configuration '" + set.name + "'";
    char text[400];
    std::snprintf(text, sizeof text,
                  "the budgets%s take %.3f of the processor; of the %.2f that the kernel leaves to real-time threads "
                  "at most %.2f can be promised: set kernel.sched_rt_runtime_us to 950000, sched_rt_period_us to "
                  "1000000",
                  of.c_str(), excess->load, share, limit < 0 ? 0.0 : limit);
    return Error{ErrorCode::kRefused, {text}, {"cpu " + std::to_string(excess->cpu)}};
  }
  return {};
}

int refuse_run(const RunRequest& request, const Error& error, std::FILE* out, std::FILE* err, int code) {
  const CommandResult output = file_refusal(error, request.json, code);
  std::fputs(for_terminal(output.out).c_str(), out);
  (void)flush_and_look(out);  // in a file that takes both, what came first stands first
  std::fputs(for_terminal(output.err).c_str(), err);
  return output.code;
}

int report_broken_run(const RunRequest& request, const BrokenRun& broken, std::FILE* out, std::FILE* err) {
  if (broken.task.empty() || request.json)
    return refuse_run(request, {ErrorCode::kRefused, {broken.text}, {broken.task.empty() ? request.file : broken.task}},
                      out, err);
  std::fprintf(err, "FAILED: %s: %s\n", broken.task.c_str(), for_terminal(broken.text).c_str());
  return kRefused;
}

std::optional<RunPlan> plan_run(const RunRequest& request, const Workplace& workplace, std::FILE* out,
                                std::FILE* err, int* code) {
  const auto library = workplace.library(request.file);
  if (library) return plan_run(request, *library, out, err, code);
  if (code != nullptr) *code = kRefused;
  refuse_run(request, library.error(), out, err);
  return std::nullopt;
}

std::optional<RunPlan> plan_run(const RunRequest& request, const Library& library, std::FILE* out, std::FILE* err,
                                int* code) {
  if (code != nullptr) *code = kRefused;
  ReadDescription reading = read_description_file(request.file);
  Verdict verdict = verify(reading, library);
  if (verdict.configuration) {
    auto set = with_settings(*verdict.configuration, library, request.settings);
    if (!set) {
      refuse_run(request, set.error(), out, err);
      return std::nullopt;
    }
    verdict.configuration = *std::move(set);
  }
  if (verdict.configuration) {
    verdict.report.add_all(faulty_objects(*verdict.configuration, library));
    verdict.report.add_all(unsupported(*verdict.configuration, executor_of(request)));
    if (verdict.report.is_legal()) verdict.report.add_all(promises(request, *verdict.configuration));
  }
  if (!request.json) std::fputs(for_terminal(verdict.report.text()).c_str(), err);
  if (!verdict.report.is_legal()) {
    if (request.json) std::fprintf(out, "%s\n", for_terminal(verdict.report.json()).c_str());
    return std::nullopt;
  }
  if (!request.json) std::fputs(verdict_text(*verdict.configuration).c_str(), out);
  RunPlan plan{library, std::move(reading.text), *std::move(verdict.configuration), {}, {}, {}, {}, {}, {}};
  if (const auto judged = judge_words(request, plan); !judged) {
    const int usage = refuse_run(request, judged.error(), out, err, kUsage);
    if (code != nullptr) *code = usage;
    return std::nullopt;
  }
  if (const auto judged = judge_throttling(request, plan.configuration); !judged) {
    refuse_run(request, judged.error(), out, err);
    return std::nullopt;
  }
  return plan;
}

}  // namespace chimera::cli
