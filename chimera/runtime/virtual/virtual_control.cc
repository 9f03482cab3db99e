// SPDX-License-Identifier: Apache-2.0
// Brings the changes and signals of other rtpus of virtual time into one rtpu.
#include "chimera/runtime/virtual/virtual_control.h"

#include <utility>

#include "chimera/runtime/cycle/boundary_signals.h"

namespace chimera {

VirtualControl::VirtualControl(VirtualPeers& peers, RtpuId rtpu, std::size_t n_acts)
    : BoundaryListener(peers.bell(rtpu)), peers_(peers), rtpu_(rtpu), tasks_(*peers.tasks(rtpu)) {
  acts_.reserve(n_acts);
}

void VirtualControl::hand_over(const ScriptAct& act) noexcept {
  acts_.push_back(act);
  peers_.ring(rtpu_);
}

void VirtualControl::stop_all() noexcept {
  stops_all_ = true;
  peers_.ring(rtpu_);
}

void VirtualControl::take(BoundarySignals& signals, Nanoseconds now) noexcept {
  listen();
  follow(now);
  if (std::exchange(stops_all_, false)) turn_all_off(signals, now);
  for (const ScriptAct& act : acts_) signals.act(act, now);
  acts_.clear();
  take_posts();
  publish();  // an act that lowers the flag changes no state
}

void VirtualControl::follow(Nanoseconds now) noexcept {
  const std::uint64_t changes = peers_.look(rtpu_);
  if (std::exchange(followed_, changes) == changes) return;
  peers_.watch_flags(rtpu_, tasks_.flag());  // an rtpu may have died
  tasks_.sources().follow_others();
  tasks_.on_set_changed();
  const bool is_up = tasks_.flag().is_up();
  if (std::exchange(is_flag_known_up_, is_up) == is_up || tap_ == nullptr) return;
  tap_->record(TapKind::kFlag, now, TaskId(), is_up ? 1 : 0);
}

void VirtualControl::take_posts() noexcept {
  for (VirtualPost post; peers_.take(rtpu_, post);) {
    if (post.is_echo) tasks_.constants().read_foreign();
    if (post.is_echo && !tasks_.constants().uses_changed(post.target)) continue;
    if (post.signal == Signal::kWakeup) (void)tasks_.sent().ring(post.target);
    else tasks_.sent().defer(tasks_.tasks()[post.target.index], post.signal);
  }
}

void VirtualControl::turn_all_off(BoundarySignals& signals, Nanoseconds now) noexcept {
  for (const TaskId id : tasks_.spec().end_order) {
    if (!tasks_.is_mine(id) || tasks_.tasks()[id.index].state != State::kOn) continue;
    if (signals.may_touch(id)) (void)signals.signal({&id, 1}, Signal::kOff, now);
    else tasks_.sent().defer(tasks_.tasks()[id.index], Signal::kOff);
  }
}

void VirtualControl::publish() noexcept {
  bool is_for_others = false;
  for (const Change& change : tasks_.changes().list())
    is_for_others |= change.kind == Change::Kind::kStatus && change.now != change.before;
  tasks_.changes().clear();
  is_for_others |= peers_.show_raised(rtpu_, tasks_.flag().is_raised() || tasks_.flag().is_held());
  is_flag_known_up_ = tasks_.flag().is_up();
  if (is_for_others) peers_.show_change(rtpu_);
}

}  // namespace chimera
