// SPDX-License-Identifier: Apache-2.0
// Writes a schedule report as JSON.

#include "chimera/analysis/schedule_report.h"
#include "chimera/analysis/schedule_words.h"
#include "chimera/description/criticality.h"
#include "chimera/description/edit_json.h"
#include "chimera/schedule/utilisation.h"
#include "chimera/text/json.h"

namespace chimera {
namespace {

Json nanoseconds(Nanoseconds time) { return time == kNever ? Json() : Json(time.count); }

const char* word(TimeSource source) {
  constexpr const char* kWords[] = {"none", "budget", "profile", "server"};
  return kWords[static_cast<std::size_t>(source)];
}

const char* word(Guarantee guarantee) {
  constexpr const char* kWords[] = {"yes", "no", "not-stated", "not-decided"};
  return kWords[static_cast<std::size_t>(guarantee)];
}

class Pages {
 public:
  explicit Pages(const Configuration& configuration) : configuration_(configuration) {}

  Json set(const SetSchedule& set) const {
    Json cpus = Json::array(), links = Json::array(), paths = Json::array();
    for (const CpuSchedule& cpu : set.cpus) cpus.push_back(this->cpu(cpu));
    for (const TaskLink& link : set.links)
      links.push_back({{"from", name(link.from.index)},
                       {"to", name(link.to.index)},
                       {"periods", link.periods()},
                       {"late", link.late}});
    for (const PathAge& path : set.paths) {
      Json tasks = Json::array();
      for (const std::size_t task : path.tasks) tasks.push_back(name(task));
      paths.push_back({{"tasks", std::move(tasks)}, {"age_ns", nanoseconds(path.age)}});
    }
    return {{"name", set.name},        {"start", set.is_start},     {"fits", set.fits()},
            {"cpus", std::move(cpus)}, {"links", std::move(links)}, {"paths", std::move(paths)},
            {"more_paths", set.has_more_paths}};
  }

 private:
  const std::string& name(std::size_t task) const { return configuration_.tasks()[task].name; }
  std::string rtpu_name(std::size_t rtpu) const { return std::string(configuration_.rtpus()[rtpu].name); }

  Json row(const ScheduleRow& row) const {
    const WorkVerdict& v = row.verdict;
    return {{"task", name(row.task)},
            {"rtpu", rtpu_name(row.work.rtpu)},
            {"criticality", criticality_name(row.work.criticality)},
            {"hard", row.is_hard},
            {"period_ns", row.work.period.count},
            {"deadline_ns", row.work.deadline.count},
            {"time_ns", row.work.time.count},
            {"source", word(row.source)},
            {"transfer", {{"groups", row.transfer.groups}, {"bytes", row.transfer.bytes}}},
            {"level", v.level},
            {"guarantee", word(v.guarantee)},
            {"response_ns", nanoseconds(v.response)},
            {"exact", v.is_exact},
            {"blocking_ns", v.blocking.count}};
  }

  Json remedy(const Remedy& remedy) const {
    Json said = change(remedy);
    said["label"] = remedy_text(configuration_, remedy);
    said["acts"] = edits_json(remedy_acts(configuration_, remedy));
    return said;
  }

  Json change(const Remedy& remedy) const {
    if (remedy.kind == Remedy::Kind::kExecutor) return {{"rtpu", rtpu_name(remedy.rtpu)}, {"executor", "preemptive"}};
    Json said = {{"task", name(remedy.task)}};
    switch (remedy.kind) {
      case Remedy::Kind::kExecutor:
        break;
      case Remedy::Kind::kRate:
        said["rate_hz"] = remedy.hz;
        break;
      case Remedy::Kind::kProcessor:
        said["rtpu"] = rtpu_name(remedy.rtpu);
        break;
      case Remedy::Kind::kNewProcessor:
        said["rtpu"] = Json();
        break;
      case Remedy::Kind::kCriticality:
        said["criticality"] = criticality_name(remedy.criticality);
        break;
    }
    return said;
  }

  Json cpu(const CpuSchedule& cpu) const {
    Json tasks = Json::array(), gives = Json::array(), helps = Json::array(), runs = Json::array(), demand;
    for (const ScheduleRow& r : cpu.rows) tasks.push_back(row(r));
    for (const std::size_t i : cpu.give_way) gives.push_back(name(cpu.rows[i].task));
    for (const Remedy& r : cpu.remedies) helps.push_back(remedy(r));
    for (const WindowRun& r : cpu.runs) runs.push_back(Json::array({name(r.task), r.from.count, r.to.count}));
    if (cpu.verdict.demand.within.count > 0)
      demand = {{"within_ns", cpu.verdict.demand.within.count}, {"ends_ns", nanoseconds(cpu.verdict.demand.ends)}};
    return {{"cpu", cpu.verdict.cpu},
            {"fits", cpu.fits()},
            {"utilisation", cpu.verdict.utilisation},
            {"limit", kMaxUtilisation},
            {"rate_monotonic_bound", cpu.verdict.rate_monotonic_bound},
            {"hyperbolic", cpu.verdict.hyperbolic},
            {"tasks", std::move(tasks)},
            {"demand", std::move(demand)},
            {"give_way", std::move(gives)},
            {"remedies", std::move(helps)},
            {"scale", cpu.scale > 0 ? Json(cpu.scale) : Json()},
            {"window", {{"length_ns", cpu.window.length.count}, {"runs", std::move(runs)}}}};
  }

  const Configuration& configuration_;
};

}  // namespace

std::string schedule_json(const Configuration& configuration, const ScheduleReport& report) {
  const Pages pages(configuration);
  Json sets = Json::array();
  for (const SetSchedule& set : report.sets) sets.push_back(pages.set(set));
  const Json all = {{"subsystem", configuration.subsystem()},
                    {"dispatch", report.dispatch_name()},
                    {"fits", report.fits()},
                    {"notes", report.notes},
                    {"sets", std::move(sets)}};
  return all.dump(Json::Style::kAsMade);
}

}  // namespace chimera
