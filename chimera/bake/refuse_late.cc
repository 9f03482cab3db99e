// SPDX-License-Identifier: Apache-2.0
// Judges the deadlines of every configuration by times that were measured on the target.
#include "chimera/analysis/schedule_parts.h"
#include "chimera/analysis/schedule_words.h"
#include "chimera/bake/refusals.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/schedule/utilisation.h"
#include "chimera/text/time_text.h"

namespace chimera::bake {
namespace {

constexpr Nanoseconds kSeldom = seconds(3600);

class Lateness {
 public:
  Lateness(const Configuration& configuration, const RecordedProfile& profile, const Target& target, Report& report)
      : configuration_(configuration), profile_(profile), report_(report) {
    if (target.has_shell())
      slice_.count = static_cast<std::int64_t>(kShellInstructions * kCyclesPerInstruction) * 1'000'000'000 /
                     target.clock_hz;
  }

  void judge() {
    if (has_all_times())
      for (const ConfiguredSet& set : configuration_.sets()) judge(set);
  }

 private:
  bool has_all_times() {
    bool has_all = true;
    for (const ConfiguredTask& task : configuration_.tasks()) {
      if (profile_.find(task.name) != nullptr) continue;
      has_all = false;
      report_.add({.rule = "unschedulable",
                   .at = task.at,
                   .message = "the profile has no measured cycle of task " + in_quotes(task.name) +
                              ", and a budget of the description does not count on the target",
                   .remedy = "record the profile on the target with every task ON, or bake without --profile",
                   .task = task.name});
    }
    return has_all;
  }

  /// The tasks of a configuration; the shell is the last one, and only blocks.
  SetWorks works_of(const ConfiguredSet& set) const {
    const ApplicationSpec& spec = configuration_.spec();
    SetWorks made{.tasks = {},
                  .works = {},
                  .uses = {{.policy = spec.rtpus[0].policy, .dispatch = Dispatch::kExecutive}},
                  .outside = {{}},
                  .may_preempt = false};
    for (const TaskId id : set.order) {
      const TaskSpec& task = spec.tasks[id.index];
      made.tasks.push_back(id.index);
      made.works.push_back({.period = task.period,
                            .deadline = task.deadline,
                            .offset = task.offset,
                            .time = profile_.find(task.name)->worst,
                            .criticality = task.criticality,
                            .user_priority = task.user_priority,
                            .rtpu = 0,
                            .place = task.place,
                            .server = {}});
      made.uses[0].criticality = std::max(made.uses[0].criticality, task.criticality);
    }
    if (slice_.count > 0) {
      made.tasks.push_back(spec.tasks.size());
      made.works.push_back({.period = kSeldom, .deadline = kSeldom, .offset = {}, .time = slice_, .place = UINT32_MAX,
                            .server = {}});
    }
    return made;
  }

  bool is_hard(std::size_t task) const {
    return !configuration_.draft().tasks[task].tolerate &&
           configuration_.spec().tasks[task].on_miss != OnMiss::kAbort;
  }

  std::string what_helps(const SetWorks& works, const CpuVerdict& verdict,
                         const std::vector<WorkVerdict>& verdicts) const {
    for (Remedy remedy : remedies(works, 0, verdicts)) {
      if (remedy.kind != Remedy::Kind::kRate && remedy.kind != Remedy::Kind::kCriticality) continue;
      remedy.task = works.tasks[remedy.task];
      if (remedy.task < configuration_.tasks().size() && !remedy.is_for_others)
        return "all keep their deadlines with " + remedy_text(configuration_, remedy);
    }
    const double scale = most_scale(works, verdict, verdicts);
    return scale > 0 ? "all keep their deadlines with times at most " + scale_text(scale) : "lower the rates";
  }

  void judge(const ConfiguredSet& set) {
    const SetWorks works = works_of(set);
    std::vector<WorkVerdict> verdicts(works.works.size());
    const CpuVerdict verdict = analyse(works, 0, verdicts);
    const bool is_full = is_beyond(verdict.utilisation);
    if (verdict.fits() && !is_full) return;
    const std::string in = configuration_.sets().size() > 1 ? " in configuration " + in_quotes(set.name) : "";
    const std::string load = formatted("%.3f", verdict.utilisation);
    const std::string helps = what_helps(works, verdict, verdicts);
    if (is_full)
      report_.add({.rule = "utilisation",
                   .at = configuration_.tasks()[0].at,
                   .message = "by the profile the tasks take " + load + " of the core" + in + "; at most " +
                              formatted("%.2f", kMaxUtilisation),
                   .found = load,
                   .remedy = helps,
                   .set = set.name});
    for (std::size_t i = 0; i < works.works.size() && works.tasks[i] < configuration_.tasks().size(); ++i)
      if (is_hard(works.tasks[i])) judge(works, i, verdicts[i], set.name, in, helps);
  }

  void judge(const SetWorks& works, std::size_t i, const WorkVerdict& verdict, const std::string& set,
             const std::string& in, const std::string& helps) {
    if (verdict.guarantee != Guarantee::kNo && verdict.guarantee != Guarantee::kTooLong) return;
    const ConfiguredTask& task = configuration_.tasks()[works.tasks[i]];
    const Work& work = works.works[i];
    std::string found = " takes up to " + time_text(work.time) + " of every " + time_text(work.period);
    if (verdict.response != kNever) found += ", ends up to " + time_text(verdict.response) + " after its release";
    if (verdict.blocking.count > 0) found += ", waits up to " + time_text(verdict.blocking) + " for a running job";
    report_.add({.rule = "unschedulable",
                 .at = task.at,
                 .message = "by the profile task " + in_quotes(task.name) + found + in + ": its deadline of " +
                            time_text(work.deadline) + " is not guaranteed",
                 .expected = "at most " + time_text(work.deadline),
                 .remedy = helps,
                 .set = set,
                 .task = task.name});
  }

  const Configuration& configuration_;
  const RecordedProfile& profile_;
  Report& report_;
  Nanoseconds slice_;
};

}  // namespace

void refuse_late(const Configuration& configuration, const RecordedProfile& profile, const Target& target,
                 Report& report) {
  Lateness(configuration, profile, target, report).judge();
}

}  // namespace chimera::bake
