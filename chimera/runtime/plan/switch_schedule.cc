// SPDX-License-Identifier: Apache-2.0
// Passes the tasks of a switch to the analysis of transitions, and reads which task would lose a guarantee.
#include "chimera/runtime/plan/switch_schedule.h"

#include <algorithm>

namespace chimera {
namespace {

bool must_keep(const TaskSpec& task) noexcept {
  return !task.server && task.tolerated_of == 0 && task.on_miss != OnMiss::kAbort;
}

Work work_of(const TaskSpec& task) noexcept {
  Work work{.period = task.period, .deadline = task.deadline, .offset = task.offset, .time = task.budget,
            .criticality = task.criticality, .user_priority = task.user_priority,
            .rtpu = task.rtpu.is_valid() ? task.rtpu.index : 0, .place = task.place,
            .server = {}};
  if (!task.server) return work;
  work.server = task.server->kind;
  work.time = task.server->capacity;
  work.period = work.deadline = task.server->period;
  return work;
}

}  // namespace

void SwitchSchedule::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  spec_ = &spec;
  works_ = memory.take<Work>(spec.tasks.size());
  parts_ = memory.take<TransitionPart>(spec.tasks.size());
  before_ = memory.take<TransitionPart>(spec.tasks.size());
  verdicts_ = memory.take<WorkVerdict>(spec.tasks.size());
  room_ = memory.take<MovingWork>(spec.tasks.size());
  uses_ = memory.take<ProcessorUse>(spec.rtpus.size());
  for (std::size_t r = 0; r < uses_.size(); ++r) {
    uses_[r].cpu = spec.rtpus[r].cpu;
    uses_[r].policy = spec.rtpus[r].policy;
    uses_[r].dispatch = spec.rtpus[r].preemptive ? Dispatch::kPreemptive : Dispatch::kExecutive;
  }
  for (std::size_t t = 0; t < works_.size(); ++t) {
    works_[t] = work_of(spec.tasks[t]);
    std::uint32_t& most = uses_[works_[t].rtpu].criticality;
    most = std::max(most, works_[t].criticality);
  }
}

void SwitchSchedule::consider(std::span<const TaskStatus> statuses, const TaskBits& after) noexcept {
  for (std::size_t t = 0; t < parts_.size(); ++t) {
    const bool was_on = statuses[t].state == State::kOn, is_on = after.has(TaskId(t));
    parts_[t] = was_on ? (is_on ? TransitionPart::kStays : TransitionPart::kLeaves)
                       : (is_on ? TransitionPart::kArrives : TransitionPart::kAbsent);
  }
  for (const StandbySpec& each : spec_->standbys)
    if (each.hot) consider_hot(each.standby);
}

// The hot standby cycles before the switch if it, or a task for which it stands in, is ON then; likewise after it.
void SwitchSchedule::consider_hot(TaskId hot) noexcept {
  bool is_before = false, is_after = false;
  for (std::size_t t = 0; t < parts_.size(); ++t) {
    if (TaskId(t) != hot && !spec_->stand_in(TaskId(t), hot)) continue;
    const TransitionPart part = parts_[t];
    is_before = is_before || part == TransitionPart::kLeaves || part == TransitionPart::kStays;
    is_after = is_after || part == TransitionPart::kArrives || part == TransitionPart::kStays;
  }
  if (is_before) parts_[hot.index] = is_after ? TransitionPart::kStays : TransitionPart::kLeaves;
  else if (is_after) parts_[hot.index] = TransitionPart::kArrives;
}

bool SwitchSchedule::is_first_of_cpu(RtpuId rtpu) const noexcept {
  for (std::uint32_t r = 0; r < rtpu.index; ++r)
    if (uses_[r].cpu == uses_[rtpu.index].cpu) return false;
  return true;
}

// Judges the tasks that must keep their deadlines.
void SwitchSchedule::analyse(std::span<const TransitionPart> parts, CpuTransition& found) noexcept {
  const TransitionVerdict all = analyse_transition(works_, parts, uses_, found.cpu, verdicts_, room_);
  found.settled = all.unstated == 0 ? all.settled : kNever;
  for (std::uint32_t t = 0; t < works_.size(); ++t) {
    if (parts[t] == TransitionPart::kAbsent || uses_[works_[t].rtpu].cpu != found.cpu) continue;
    const Guarantee each = verdicts_[t].guarantee;
    if (each == Guarantee::kYes || !must_keep(spec_->tasks[t])) continue;
    const bool is_worse = found.guarantee == Guarantee::kYes ||
                          (found.guarantee == Guarantee::kNotStated && each != Guarantee::kNotStated);
    if (!is_worse) continue;
    found.guarantee = each;
    found.task = TaskId(t);
    found.takes = verdicts_[t].response;
  }
}

CpuTransition SwitchSchedule::on_cpu_of(RtpuId rtpu) noexcept {
  CpuTransition found, before;
  found.cpu = before.cpu = uses_[rtpu.index].cpu;
  for (std::size_t t = 0; t < parts_.size(); ++t) {
    const TransitionPart part = parts_[t];
    const bool moves = part == TransitionPart::kLeaves || part == TransitionPart::kArrives;
    found.is_moved = found.is_moved || (moves && uses_[works_[t].rtpu].cpu == found.cpu);
    const bool is_before = part == TransitionPart::kLeaves || part == TransitionPart::kStays;
    before_[t] = is_before ? TransitionPart::kStays : TransitionPart::kAbsent;
  }
  analyse(parts_, found);
  if (!found.is_lost()) return found;
  analyse(before_, before);
  found.was_promised = !before.is_lost();
  return found;
}

PlanAnswer SwitchSchedule::judge(std::span<const TaskStatus> statuses, const TaskBits& after) noexcept {
  consider(statuses, after);
  for (std::uint32_t r = 0; r < uses_.size(); ++r) {
    if (!is_first_of_cpu(RtpuId(r))) continue;
    const CpuTransition found = on_cpu_of(RtpuId(r));
    if (found.is_moved && found.is_lost() && found.was_promised)
      return {NoSwitch::kNotSchedulable, found.task, found.takes};
  }
  return {};
}

}  // namespace chimera
