// SPDX-License-Identifier: Apache-2.0
// Refuses, by name, all parts of a description that `check` accepts but the executors do not support yet.
#include <algorithm>

#include "chimera/runtime/hosted/together.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

class Refusals {
 public:
  Refusals(const Configuration& configuration, Executor executor)
      : configuration_(configuration), executor_(executor), report_(configuration.file(), configuration.draft().keys) {}

  Report take() {
    for (std::size_t i = 0; i < configuration_.rtpus().size(); ++i) rtpu(i);
    for (const ConfiguredSet& set : configuration_.sets())
      if (!is_virtual()) load(set);
    for (const DraftTask& task : configuration_.draft().tasks) judge(task);
    report_.sort();
    return std::move(report_);
  }

 private:
  void refuse(Place at, const std::string& what, std::string remedy) {
    report_.add({.rule = "not-built",
                 .at = at,
                 .message = what + ": run cannot do this yet",
                 .remedy = std::move(remedy)});
  }
  void refuse_key(Place at, const char* key, const DraftTask& task) {
    refuse(at, "'" + std::string(key) + "' of task '" + task.name.text + "'", "take it out to run");
  }

  bool is_virtual() const { return executor_ == Executor::kVirtual || executor_ == Executor::kPreemptiveVirtual; }
  bool is_preemptive(std::size_t rtpu) const {
    if (executor_ == Executor::kPreemptiveVirtual) return true;
    return executor_ != Executor::kOneProcess && configuration_.rtpus()[rtpu].preemptive;
  }

  void rtpu(std::size_t index) {
    const RtpuSpec& spec = configuration_.rtpus()[index];
    if (!is_virtual() && spec.policy == Policy::kLlf)
      refuse(configuration_.draft().rtpus[index].policy.at, "policy llf in real time",
             "use muf-laxity, or run --virtual");
    if (spec.link.is_there() && executor_ == Executor::kOneProcess)
      refuse(configuration_.draft().rtpus[index].link->at,
             "'link' of rtpu '" + std::string(spec.name) + "' in one process", "run without --isolation none");
  }

  // A switch or a takeover may lead to each configuration. In one process all tasks run on the CPU of the first rtpu.
  void load(const ConfiguredSet& set) {
    const ApplicationSpec& spec = configuration_.spec();
    std::string what = "budgets above 0.93 of a CPU in real time";
    const char* remedy = "run --virtual";
    auto excess = excess_of(spec, set.order);
    if (!excess && executor_ == Executor::kOneProcess) {
      excess = excess_of(spec, set.order, kMaxUtilisation, true);
      what = "budgets of all rtpus together above 0.93 of one CPU in one process";
      remedy = "run without --isolation none";
    }
    if (!excess) return;
    const bool is_start = &set == &configuration_.sets()[configuration_.start()];
    if (!is_start || excess->together.is_takeover())
      what += ", in configuration '" + set.name + "'" + takeover_text(spec, excess->together);
    refuse(is_start ? configuration_.tasks()[0].at : set.at, what, remedy);
  }

  void reaction(const std::optional<DraftReaction>& reaction, const char* key, const DraftTask& task,
                bool is_preemptive) {
    if (!reaction || reaction->kind != OnMiss::kDemote || is_preemptive) return;
    const std::string what = "'" + std::string(key) + ": demote' of task '" + task.name.text + "'";
    const char* const remedy = executor_ == Executor::kOneProcess ? "run without --isolation none"
                               : executor_ == Executor::kVirtual  ? "run with --preemptive"
                                                                  : "give its rtpu 'executor: preemptive'";
    refuse(reaction->at, what, std::string(remedy) + ", or use another reaction");
  }

  // A job behind a server loses the processor when the capacity is used up; a single loop cannot do that.
  void server(const DraftTask& task, bool preempts, bool has_source) {
    if (task.server && has_source && is_virtual())
      refuse(task.server->at, "events of task '" + task.name.text + "' from a descriptor, in virtual time",
             "run without --virtual, or take a component whose events are rung");
    if (!task.server || preempts) return;
    std::string remedy = executor_ == Executor::kVirtual ? "run --virtual --preemptive, or give" : "give";
    if (executor_ == Executor::kOneProcess) remedy = "run without --isolation none, and give";
    refuse(task.server->at, "'server' of task '" + task.name.text + "'", remedy + " its rtpu 'executor: preemptive'");
  }

  void judge(const DraftTask& task) {
    const auto tasks = configuration_.tasks();
    const auto here =
        std::find_if(tasks.begin(), tasks.end(), [&](const ConfiguredTask& t) { return t.name == task.name.text; });
    const bool preempts = here != tasks.end() && is_preemptive(here->rtpu);
    reaction(task.on_miss, "on_miss", task, preempts);
    reaction(task.on_overrun, "on_overrun", task, preempts);
    server(task, preempts, here != tasks.end() && here->has_event_source);
    if (task.stack_bytes && !preempts && executor_ == Executor::kProcesses)
      refuse(task.stack_bytes->at, "'stack' of task '" + task.name.text + "'",
             "give its rtpu 'executor: preemptive': in one loop tasks have no stacks of their own");
    if (task.own_process && task.own_process->value) refuse_key(task.own_process->at, "isolation: process", task);
  }

  const Configuration& configuration_;
  Executor executor_;
  Report report_;
};

}  // namespace

Report unsupported(const Configuration& configuration, Executor executor) {
  return Refusals(configuration, executor).take();
}

}  // namespace chimera
