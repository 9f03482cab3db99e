// SPDX-License-Identifier: Apache-2.0
// Ends the tasks of an rtpu step by step, and waits a limited time for tasks of other rtpus that must end first.
#include "chimera/rtpu/rtpu_end.h"

#include "chimera/platform/process.h"

namespace chimera {
namespace {

// Also without a keeper, which would show the death.
bool has_died(const PeerSegment* peer) noexcept {
  const std::int32_t pid = peer == nullptr ? 0 : peer->block().head().pid.load(std::memory_order_relaxed);
  return pid > 0 && has_process_ended(pid);
}

}  // namespace

bool RtpuEnd::go_on(BoundarySignals& signals, Nanoseconds now) noexcept {
  others_.keep_last_words(is_alone_, tasks_);
  if (!has_begun_) {
    has_begun_ = true;
    patience_ = now + method_limit_;
    others_.block().head().phase.store(PeerPhase::kEnding, std::memory_order_release);
  }
  if (!turn_off_next(signals, now) || !kill_next(signals, now)) return false;
  others_.block().head().phase.store(PeerPhase::kEnded, std::memory_order_release);
  over_ = true;
  return true;
}

// True if the task of another rtpu must be OFF first. If this rtpu ends alone, the others stay ON. A dead rtpu is not
// waited for, and no rtpu again after the whole limit.
bool RtpuEnd::is_awaited(TaskId id, Nanoseconds now) noexcept {
  const std::uint32_t rtpu = tasks_.spec().tasks[id.index].rtpu.index, bit = 1u << rtpu;
  if (is_alone_ || hanging_.any() || (passed_over_ & bit) != 0 || others_.state(id) != State::kOn) return false;
  if (now < patience_ && !has_died(others_.at(rtpu))) return true;
  passed_over_ |= bit;
  return false;
}

// True if no task of this rtpu is ON any more.
bool RtpuEnd::turn_off_next(BoundarySignals& signals, Nanoseconds now) noexcept {
  for (; next_off_ < tasks_.spec().end_order.size(); ++next_off_) {
    const TaskId id = tasks_.spec().end_order[next_off_];
    if (!tasks_.is_mine(id)) {
      if (is_awaited(id, now)) return false;
      continue;
    }
    if (tasks_.tasks()[id.index].state != State::kOn) continue;
    if (!signals.may_touch(id)) {  // its job ends soon, or hangs
      if (now < patience_ && !hanging_.has(id)) return false;
      continue;
    }
    (void)supervised_.carry_out(signals, {&id, 1}, Signal::kOff, now);
    patience_ = now + method_limit_;
  }
  return true;
}

// True if all tasks of this rtpu are killed.
bool RtpuEnd::kill_next(BoundarySignals& signals, Nanoseconds now) noexcept {
  bool is_done = true;
  for (const TaskId id : tasks_.spec().end_order) {
    if (!tasks_.is_mine(id)) continue;
    const Task& task = tasks_.tasks()[id.index];
    if (task.in_service()) return false;
    if (task.state == State::kNotCreated) continue;
    if (!signals.may_touch(id)) {
      is_done = is_done && hanging_.has(id);
      continue;
    }
    if (supervised_.carry_out(signals, {&id, 1}, Signal::kKill, now).is_deferred) return false;
  }
  return is_done;
}

}  // namespace chimera
