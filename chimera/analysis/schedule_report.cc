// SPDX-License-Identifier: Apache-2.0
// Runs the schedulability analysis for each set of tasks and each CPU, and names the tasks.
#include "chimera/analysis/schedule_report.h"

#include <algorithm>

#include "chimera/analysis/schedule_parts.h"
#include "chimera/base/assert.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/hosted/together.h"
#include "chimera/schedule/utilisation.h"
#include "chimera/text/time_text.h"

namespace chimera {
namespace {

constexpr std::size_t kMostRuns = 400;
constexpr std::uint64_t kFewSamples = 100;
constexpr std::int64_t kMostPeriods = 4;  // of the longest, in the picture

class ReportWriter {
 public:
  ReportWriter(const Configuration& configuration, const ScheduleOptions& options)
      : configuration_(configuration), options_(options) {}

  ScheduleReport write() {
    for (const RtpuSpec& rtpu : configuration_.rtpus()) report_.dispatch.push_back(dispatch(rtpu));
    note_unknown();
    for (std::size_t s = 0; s < configuration_.sets().size(); ++s) {
      const ConfiguredSet& configured = configuration_.sets()[s];
      for (const Together& each : all_together(configuration_.spec().standbys, configured.order))
        report_.sets.push_back(set(configured.name + takeover(each), each.tasks,
                                   s == configuration_.start() && !each.is_takeover()));
    }
    return std::move(report_);
  }

 private:
  Dispatch dispatch(const RtpuSpec& rtpu) const {
    const Dispatch own = rtpu.preemptive && !options_.one_rtpu ? Dispatch::kPreemptive : Dispatch::kExecutive;
    return options_.dispatch.value_or(own);
  }

  void note_unknown() {
    if (options_.profile == nullptr) return;
    const auto unknown = [this](const std::string& name) {
      return std::ranges::find(configuration_.tasks(), name, &ConfiguredTask::name) == configuration_.tasks().end();
    };
    if (options_.profile->subsystem != configuration_.subsystem())
      report_.notes.push_back("the profile was recorded of subsystem '" + options_.profile->subsystem +
                              "': tasks of the same name have their times from it");
    for (const RecordedTask& task : options_.profile->tasks)
      if (unknown(task.task)) report_.notes.push_back("the profile has a task '" + task.task + "' that is not there");
    note_measured();
  }

  /// Notes measured times above their budgets, and tasks with too few measured cycles.
  void note_measured() {
    std::string few;
    for (const TaskSpec& task : configuration_.spec().tasks) {
      const RecordedTask* seen = options_.profile->find(task.name);
      if (seen == nullptr || task.server) continue;
      const std::string name(task.name);
      if (task.budget.count > 0 && seen->worst > task.budget)
        report_.notes.push_back("task '" + name + "' was seen to take " + time_text(seen->worst) +
                                ", more than its budget of " + time_text(task.budget));
      if (seen->samples < kFewSamples) append_joined(few, ", ", name + " " + std::to_string(seen->samples));
    }
    if (!few.empty()) report_.notes.push_back("few cycles were measured: " + few + "; the longest of few is no bound");
  }

  std::vector<ProcessorUse> uses() const {
    std::vector<ProcessorUse> made;
    for (const RtpuSpec& rtpu : configuration_.rtpus())
      made.push_back({.cpu = rtpu.cpu,
                      .criticality = 0,
                      .policy = rtpu.policy,
                      .dispatch = dispatch(rtpu),
                      .quantum = options_.quantum});
    for (const TaskSpec& task : configuration_.spec().tasks) {
      std::uint32_t& most = made[options_.one_rtpu ? 0 : task.rtpu.index].criticality;
      most = std::max(most, task.criticality);
    }
    return made;
  }

  std::vector<Outside> outside(const std::vector<std::size_t>& set) const {
    std::vector<Outside> made(configuration_.rtpus().size());
    const auto tasks = configuration_.spec().tasks;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (std::binary_search(set.begin(), set.end(), i)) continue;
      Outside& of = made[options_.one_rtpu ? 0 : tasks[i].rtpu.index];
      of.least = std::min(of.least, tasks[i].criticality);
      of.most = std::max(of.most, tasks[i].criticality);
    }
    return made;
  }

  ScheduleRow row(std::size_t task) const {
    const TaskSpec& spec = configuration_.spec().tasks[task];
    const DraftTask& draft = configuration_.draft().tasks[task];
    ScheduleRow made;
    made.task = task;
    made.work = {.period = spec.period,
                 .deadline = spec.deadline,
                 .offset = spec.offset,
                 .time = spec.budget,
                 .criticality = spec.criticality,
                 .user_priority = spec.user_priority,
                 .rtpu = options_.one_rtpu ? 0 : spec.rtpu.index,
                 .place = spec.place,
                 .server = {}};
    made.source = spec.budget.count > 0 ? TimeSource::kBudget : TimeSource::kNone;
    const RecordedTask* seen = options_.profile == nullptr ? nullptr : options_.profile->find(spec.name);
    if (seen != nullptr) {
      made.work.time = seen->worst;
      made.source = TimeSource::kProfile;
    }
    if (draft.server) {
      made.work.server = draft.server->kind;
      made.work.time = draft.server->capacity.value;
      made.work.period = made.work.deadline = draft.server->period.value;
      made.source = TimeSource::kServer;
    }
    const bool may_miss =
        std::find(options_.may_miss.begin(), options_.may_miss.end(), spec.name) != options_.may_miss.end();
    made.is_hard = !may_miss && !draft.server && !draft.tolerate && spec.on_miss != OnMiss::kAbort;
    made.transfer = transfer_of(configuration_, task);
    return made;
  }

  std::string takeover(const Together& each) const {
    if (!each.is_takeover()) return {};
    const auto names = configuration_.tasks();
    return " with " + names[each.standby.index].name + " for " + names[each.primary.index].name;
  }

  SetSchedule set(const std::string& name, const std::vector<TaskId>& tasks, bool is_start) {
    SetSchedule made{.name = name, .is_start = is_start, .cpus = {}, .links = {}, .paths = {}};
    SetWorks works{.tasks = {}, .works = {}, .uses = uses(), .outside = {}, .may_preempt = !options_.one_rtpu};
    for (const TaskId id : tasks) works.tasks.push_back(id.index);
    std::sort(works.tasks.begin(), works.tasks.end());
    works.outside = outside(works.tasks);
    std::vector<ScheduleRow> rows;
    rows.reserve(works.tasks.size());
    works.works.reserve(works.tasks.size());
    for (const std::size_t task : works.tasks) {
      rows.push_back(row(task));
      works.works.push_back(rows.back().work);
    }
    std::vector<std::uint32_t> cpus;
    for (const ScheduleRow& r : rows) cpus.push_back(works.uses[r.work.rtpu].cpu);
    std::sort(cpus.begin(), cpus.end());
    cpus.erase(std::unique(cpus.begin(), cpus.end()), cpus.end());
    std::vector<WorkVerdict> verdicts(rows.size());
    for (const std::uint32_t cpu : cpus) made.cpus.push_back(judge(works, rows, cpu, verdicts));
    made.links = links_among(configuration_.spec(), tasks);
    find_paths(configuration_, works, verdicts, made);
    return made;
  }

  CpuSchedule judge(const SetWorks& set, const std::vector<ScheduleRow>& rows, std::uint32_t cpu,
                    std::vector<WorkVerdict>& verdicts) const {
    CpuSchedule made;
    made.verdict = analyse(set, cpu, verdicts);
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (set.uses[rows[i].work.rtpu].cpu == cpu) places.push_back(i);
    std::stable_sort(places.begin(), places.end(),
                     [&](std::size_t a, std::size_t b) { return verdicts[a].level < verdicts[b].level; });
    for (const std::size_t place : places) {
      made.rows.push_back(rows[place]);
      made.rows.back().verdict = verdicts[place];
    }
    if (!made.fits()) {
      for (const std::size_t i : give_way(set, cpu, verdicts))
        made.give_way.push_back(static_cast<std::size_t>(std::find(places.begin(), places.end(), i) - places.begin()));
      made.remedies = remedies(set, cpu, verdicts);
      for (Remedy& remedy : made.remedies) remedy.task = set.tasks[remedy.task];
    }
    made.scale = most_scale(set, made.verdict, verdicts);
    draw(set, cpu, made);
    return made;
  }

  void draw(const SetWorks& set, std::uint32_t cpu, CpuSchedule& made) const {
    // Up to the last first response, or the first miss.
    Nanoseconds length, longest;
    for (const ScheduleRow& r : made.rows) {
      if (r.source == TimeSource::kNone) continue;
      longest = std::max(longest, r.work.period);
      length = std::max(length, r.verdict.response < r.work.period ? r.verdict.response : r.work.period);
    }
    length = std::min(std::max(length, made.verdict.demand.within), longest * kMostPeriods);
    if (length.count == 0) return;
    made.runs.resize(kMostRuns);
    std::vector<WindowTask> room(set.works.size());
    made.window = worst_window(set.works, set.uses, cpu, length, room, made.runs);
    made.runs.resize(made.window.runs);
    for (WindowRun& run : made.runs) run.task = static_cast<std::uint32_t>(set.tasks[run.task]);
  }

  const Configuration& configuration_;
  const ScheduleOptions& options_;
  ScheduleReport report_;
};

template <class Parts>
bool all_fit(const Parts& parts) {
  return std::all_of(parts.begin(), parts.end(), [](const auto& part) { return part.fits(); });
}

}  // namespace

bool CpuSchedule::fits() const noexcept { return verdict.fits() && !is_beyond(verdict.utilisation); }
bool SetSchedule::fits() const noexcept { return all_fit(cpus); }
bool ScheduleReport::fits() const noexcept { return all_fit(sets); }

const char* ScheduleReport::dispatch_name() const noexcept {
  const auto preemptive = std::count(dispatch.begin(), dispatch.end(), Dispatch::kPreemptive);
  if (preemptive == 0) return "executive";
  return preemptive == std::ssize(dispatch) ? "preemptive" : "mixed";
}

ScheduleReport schedule_report(const Configuration& configuration, const ScheduleOptions& options) {
  return ReportWriter(configuration, options).write();
}

}  // namespace chimera
