// SPDX-License-Identifier: Apache-2.0
// Hands signals of tasks to their targets, and keeps the last request for a configuration.
#include "chimera/runtime/life/sent_signals.h"

#include <utility>

namespace chimera {

bool SentSignals::ring(TaskId id) noexcept {
  Task& task = tasks_[id.index];
  if (!task.spec->has_doorbell()) return false;
  const bool answers = task.spec->server || task.by_events;
  const bool counts = answers && task.state == State::kOn && task.events < UINT32_MAX;
  if (counts) ++task.events;
  ++(counts ? task.profile.events : task.profile.events_lost);
  if (!counts || !task.by_events) return counts;
  if (!was_rung_) ++n_pending_;
  was_rung_ = true;
  return true;
}

void SentSignals::deliver(Task& task) noexcept {
  for (const SentSignal& sent : task.outbox) {
    Task& target = tasks_[sent.target.index];
    if (sent.signal == Signal::kWakeup && is_mine(sent.target)) {
      (void)ring(sent.target);
      continue;
    }
    PeerView* const others = mechanisms::kPeers ? others_ : nullptr;
    const bool goes_to_manager = sent.signal == Signal::kOn && others != nullptr && others->has_manager();
    if (others != nullptr && (!is_mine(sent.target) || goes_to_manager)) {
      const bool is_sent = others->post(sent.signal, sent.target, task.id, false);
      if (!is_sent && sent.signal == Signal::kWakeup) ++task.profile.events_lost;
      continue;
    }
    defer(target, sent.signal);
  }
  if (!mechanisms::kSwitch || task.requested_set == kNoRequest) return task.forget_sent();
  if (task.requested_set == kListsRequested) request({UINT32_MAX, SwitchCause::kRequest, task.id, *lists_of(task.id)});
  else request({task.requested_set, SwitchCause::kRequest, task.id});
  task.forget_sent();
}

void SentSignals::request(const SwitchRequest& request) noexcept {
  if (!request_) ++n_pending_;
  request_ = request;
}

SwitchRequest SentSignals::take_request() noexcept {
  if (request_) --n_pending_;
  return std::exchange(request_, {});
}

void SentSignals::defer(Task& task, Signal signal) noexcept {
  if (task.pending.try_push(signal)) ++n_pending_;
  else if (signal == Signal::kKill) task.pending.replace_newest(Signal::kKill);
}

bool SentSignals::take_pending(Task& task, Signal& signal) noexcept {
  if (task.pending.empty()) return false;
  signal = task.pending.take_oldest();
  --n_pending_;
  return true;
}

}  // namespace chimera
