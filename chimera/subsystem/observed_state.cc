// SPDX-License-Identifier: Apache-2.0
// Keeps the last reported state of each process and task.
#include "chimera/subsystem/observed_state.h"

namespace chimera::subsystem {

void ObservedState::see(TaskId task, TaskStatus status) noexcept {
  tasks_[task.index].status = status;
  tasks_[task.index].is_seen = true;
  if (status.state != State::kNotCreated) tasks_[task.index].is_lost = false;
}

void ObservedState::up(RtpuId rtpu, std::uint32_t incarnation) noexcept {
  rtpus_[rtpu.index].life = RtpuLife::kUp;
  rtpus_[rtpu.index].incarnation = incarnation;
}

void ObservedState::down(RtpuId rtpu, std::uint32_t incarnation) noexcept {
  rtpus_[rtpu.index].life = RtpuLife::kDown;
  rtpus_[rtpu.index].incarnation = incarnation;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    if (spec_.tasks[t].rtpu != rtpu) continue;
    if (tasks_[t].status.state != State::kNotCreated) tasks_[t].is_lost = true;
    tasks_[t].status = {};
    tasks_[t].is_seen = true;
  }
}

void ObservedState::begin_empty() noexcept {
  for (Task& task : tasks_) task.is_seen = true;
}

void ObservedState::starting(RtpuId rtpu, Nanoseconds now) noexcept {
  if (life(rtpu) == RtpuLife::kDown) rtpus_[rtpu.index].life = RtpuLife::kStarting;
  rtpus_[rtpu.index].since = now;
}

State ObservedState::state(TaskId task) const noexcept { return is_lost(task) ? State::kError : status(task).state; }

}  // namespace chimera::subsystem
