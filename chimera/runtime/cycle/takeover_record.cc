// SPDX-License-Identifier: Apache-2.0
// Measures takeovers by standbys of its own context, and reports them.
#include "chimera/runtime/cycle/takeover_record.h"

#include <algorithm>
#include <string_view>

namespace chimera {

void TakeoverRecord::prepare(SwitchPeers* peers) {
  peers_ = peers;
  const auto standbys = set_.spec().standbys;
  const auto is_mine = [this](const StandbySpec& each) {
    return set_.is_mine(each.standby) || set_.is_mine(each.primary);
  };
  if (std::none_of(standbys.begin(), standbys.end(), is_mine)) return;
  open_ = set_.setup_memory().take<Open>(set_.standbys().n_groups());
  steps_.prepare();
  delays_.prepare(set_.tasks().size(), set_.setup_memory());
}

// The task that failed counts as ON, too.
std::uint32_t TakeoverRecord::set_in_force(TaskId failed) const noexcept {
  return chimera::set_in_force(set_.spec(), [&](TaskId id) {
    const bool is_elsewhere = set_.others() != nullptr && !set_.is_mine(id);
    const State state = is_elsewhere ? set_.others()->state(id) : set_.tasks()[id.index].shown_state();
    return state == State::kOn || id == failed;
  });
}

void TakeoverRecord::list_handovers(Takeover& takeover) noexcept {
  const auto variables = set_.spec().variables;
  const auto find = [](const Variable& variable, TaskId task) {
    return variable.producer([task](TaskId producer) { return producer == task; });
  };
  takeover.n_variables = 0;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const PortOf* const from = find(variables[v], takeover.from);
    const PortOf* const to = find(variables[v], takeover.standby.task);
    if (from == nullptr || to == nullptr) continue;
    if (takeover.n_variables < Takeover::kVariablesKept)
      takeover.variables[takeover.n_variables] = {{VariableId(v), *from, *to}, {}, {}, {}};
    ++takeover.n_variables;
  }
}

void TakeoverRecord::begin(std::size_t group, TaskId standby) noexcept {
  Open& open = open_[group];
  Takeover& takeover = open.takeover;
  const Standbys::Loss loss = set_.standbys().loss(group);
  if (open.is_open && takeover.standby.task == standby && takeover.lost == loss.at) return;
  if (open.is_open) close(group, NoSwitch::kDisturbed, loss.at);  // it failed before its first cycle was seen
  takeover = {};
  takeover.from = loss.task;
  takeover.set = set_in_force(takeover.from);
  takeover.was_death = !set_.is_mine(takeover.from) && !set_.others()->presence(takeover.from).lives;
  takeover.lost = loss.at;
  takeover.standby.task = standby;
  takeover.standby.move = TaskMove::kArrives;
  takeover.standby.delay_before = delays_.begin(task(standby));
  list_handovers(takeover);
  steps_.keep_last(takeover.kept());
  open.is_open = true;
  open.first_cycle_by = kNever;
}

void TakeoverRecord::done(std::size_t group, Nanoseconds now) noexcept {
  Open& open = open_[group];
  Takeover& takeover = open.takeover;
  Task& standby = task(takeover.standby.task);
  takeover.at = now;
  takeover.flag = std::max(Nanoseconds{}, now - set_.standbys().loss(group).covered_until);
  for (VariablePart& part : takeover.kept()) part.step_of_on = steps_.step_to(part.handover);
  open.cycles = standby.profile.cycles;
  open.losses = losses_of(standby);
  open.first_cycle_by = first_cycle_by(*standby.spec, now);
  tell(takeover);
  look(now, false);
}

void TakeoverRecord::failed(std::size_t group, NoSwitch why, Nanoseconds now) noexcept {
  Open& open = open_[group];
  Takeover& takeover = open.takeover;
  takeover.end = SwitchEnd::kAborted;
  takeover.why = why;
  const std::string_view said(task(takeover.standby.task).faults.last.text);
  if (why == NoSwitch::kOnFailed || why == NoSwitch::kStepFailed)
    std::copy_n(said.begin(), std::min<std::size_t>(said.size(), Takeover::kSaid), takeover.said);
  takeover.ended = now;
  open.is_open = false;
  tell(takeover);
}

void TakeoverRecord::look(Nanoseconds now, bool is_last) noexcept {
  due_ = kNever;
  for (std::size_t group = 0; group < open_.size(); ++group) {
    const Open& open = open_[group];
    if (!open.is_open) continue;
    const Task& standby = task(open.takeover.standby.task);
    const bool is_on = open.first_cycle_by != kNever;
    const bool has_cycled = is_on && !standby.is_busy && standby.profile.cycles != open.cycles;
    const bool has_gone = is_on ? standby.state != State::kOn : !set_.standbys().next(group).is_valid();
    if (has_cycled || has_gone || now >= open.first_cycle_by || is_last) {
      close(group, is_last ? NoSwitch::kRunEnded : NoSwitch::kDisturbed, now);
    } else if (is_on) {
      threads_.await_job(standby.id);
      due_ = std::min(due_, open.first_cycle_by);
    }
  }
}

void TakeoverRecord::close(std::size_t group, NoSwitch why, Nanoseconds now) noexcept {
  Open& open = open_[group];
  open.first_cycle_by == kNever ? failed(group, why, now) : end(open, now);
}

void TakeoverRecord::tell(Takeover& takeover) noexcept {
  if (takeover.number == 0) takeover.number = ++n_told_;
  if (peers_ != nullptr) peers_->tell_takeover(takeover);
}

void TakeoverRecord::end(Open& open, Nanoseconds now) noexcept {
  Takeover& takeover = open.takeover;
  Task& standby = task(takeover.standby.task);
  if (!standby.is_busy) {
    takeover.standby.delay = delays_.look(standby);
    if (standby.profile.cycles != open.cycles)
      for (VariablePart& part : takeover.kept()) part.step_of_cycle = steps_.step_to(part.handover);
  }
  takeover.standby.lost = losses_of(standby) - open.losses;
  takeover.ended = now;
  open.is_open = false;
  tell(takeover);
}

}  // namespace chimera
