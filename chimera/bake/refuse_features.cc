// SPDX-License-Identifier: Apache-2.0
// Refuses, by name, what needs Linux or more than one non-preemptive loop.
#include "chimera/bake/refusals.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/plan/switch_agreement.h"

namespace chimera::bake {
namespace {

class Features {
 public:
  Features(const Configuration& configuration, const Library& library, Report& report)
      : configuration_(configuration), library_(library), report_(report) {}

  void judge() {
    const auto& rtpus = configuration_.draft().rtpus;
    if (rtpus.size() > 1)
      refuse(rtpus[1].name.at, counted(rtpus.size(), "rtpu") + "; an image has 1",
             "put every task on '" + rtpus[0].name.text + "', or bake one description for each board");
    const auto& tasks = configuration_.draft().tasks;
    if (tasks.size() > kMostTasksOfImage)
      refuse(tasks[kMostTasksOfImage].name.at, counted(tasks.size(), "task"),
             "it has room for " + std::to_string(kMostTasksOfImage));
    for (const DraftRtpu& rtpu : rtpus) judge(rtpu);
    for (const DraftTask& task : configuration_.draft().tasks) judge(task);
    for (const ConfiguredTask& task : configuration_.tasks()) component(task);
  }

 private:
  void refuse(Place at, const std::string& what, std::string remedy) {
    report_.add({.rule = "not-built", .at = at, .message = "an image cannot have " + what,
                 .remedy = std::move(remedy)});
  }

  void judge(const DraftRtpu& rtpu) {
    const std::string name = in_quotes(rtpu.name.text);
    if (rtpu.preemptive.value)
      refuse(rtpu.preemptive.at, "the executor 'preemptive' of rtpu " + name,
             "write 'executor: executive': one loop runs all jobs, each to its end");
    if (rtpu.policy.value == Policy::kLlf || rtpu.policy.value == Policy::kMufLaxity)
      refuse(rtpu.policy.at, "the policy '" + std::string(policy_name(rtpu.policy.value)) + "' of rtpu " + name,
             "write 'policy: rm', 'edf' or 'muf': laxity needs budgets and preemption");
  }

  void reaction(const std::optional<DraftReaction>& reaction, const char* key, const std::string& name) {
    if (reaction && reaction->kind == OnMiss::kDemote)
      refuse(reaction->at, "'" + std::string(key) + ": demote' of task " + name,
             "use another reaction: a running job is never preempted");
  }

  void judge(const DraftTask& task) {
    const std::string name = in_quotes(task.name.text);
    if (task.server)
      refuse(task.server->at, "'server' of task " + name,
             "leave it out: without a server the task looks for an event at its rate");
    if (task.standby_for)
      refuse(task.standby_for->task.at, "'standby_for' of task " + name,
             "leave it out, or react with 'on_fault: {switch: CONFIGURATION}'");
    if (task.own_process && task.own_process->value)
      refuse(task.own_process->at, "'isolation: process' of task " + name, "leave it out: a board has no processes");
    if (task.stack_bytes)
      refuse(task.stack_bytes->at, "'stack' of task " + name,
             "write 'stack' in the target: all tasks run on one stack");
    if (task.safe_after)
      refuse(task.safe_after->at, "'safe_after' of task " + name,
             "leave it out and write 'safe_writes' and 'watchdog' in the target");
    reaction(task.on_miss, "on_miss", name);
    reaction(task.on_overrun, "on_overrun", name);
  }

  void component(const ConfiguredTask& task) {
    const LibraryEntry* entry = library_.find(task.component);
    if (entry == nullptr || !entry->descriptor.background) return;
    refuse(task.at, "the component " + in_quotes(task.component) + " of task " + in_quotes(task.name) +
           ": its background work needs a thread of Linux", "use a component without 'background: true'");
  }

  const Configuration& configuration_;
  const Library& library_;
  Report& report_;
};

}  // namespace

void refuse_features(const Configuration& configuration, const Library& library, Report& report) {
  Features(configuration, library, report).judge();
}

}  // namespace chimera::bake
