// SPDX-License-Identifier: Apache-2.0
// Turns standbys ON and restarts tasks at cycle boundaries.
#include "chimera/runtime/cycle/recovery.h"

#include <algorithm>

#include "chimera/base/message.h"
#include "chimera/runtime/switch/arming.h"

namespace chimera {
namespace {

// Interval of the check whether another context has seen that a task failed. That context rings no bell for it.
constexpr Nanoseconds kLookForSeen = microseconds(200);

/// Returns when to call `on` again of a task that was not ready.
Nanoseconds ask_again_at(const Task& task, Nanoseconds now) noexcept {
  return now + std::max(task.spec->period, TaskLife::kAskAgain);
}

void count(std::uint16_t& counter) noexcept {
  if (counter < UINT16_MAX) ++counter;
}

}  // namespace

void Recovery::prepare(SwitchPeers* peers) {
  TaskSet& set = parts_.set;
  const auto is_hot = [&](const StandbySpec& each) { return each.hot && set.is_mine(each.standby); };
  const auto standbys = set.spec().standbys;
  hot_ = set.setup_memory().take<HotStandby>(
      static_cast<std::size_t>(std::count_if(standbys.begin(), standbys.end(), is_hot)));
  std::size_t n_hot = 0;
  for (const StandbySpec& each : standbys)
    if (is_hot(each)) hot_[n_hot++].task = each.standby;
  record_.prepare(peers);
  takeovers_ = set.setup_memory().take<UnderWay>(set.standbys().n_groups());
  const auto specs = set.spec().restarts;
  const auto is_mine = [&](const RestartSpec& spec) { return set.is_mine(spec.task); };
  restarts_ = set.setup_memory().take<Restart>(
      static_cast<std::size_t>(std::count_if(specs.begin(), specs.end(), is_mine)));
  std::size_t n = 0;
  for (const RestartSpec& spec : specs)
    if (is_mine(spec)) restarts_[n++].spec = &spec;
}

// A task that may not be touched yet is checked again at the next cycle boundary.
void Recovery::act(Nanoseconds now) noexcept {
  Standbys& standbys = parts_.set.standbys();
  if (restarts_.empty() && standbys.n_groups() == 0) return;
  if (standbys.due() <= now) parts_.set.on_set_changed();
  due_ = wake_ = kNever;
  bool is_done = true;
  for (std::size_t group = 0; group < standbys.n_groups(); ++group) is_done = take_over(group, now) && is_done;
  record_.look(now, false);
  if (record_.due() != kNever) look_again(now, record_.due());
  for (Restart& each : restarts_) is_done = restart(each, now) && is_done;
  if (is_done) parts_.set.sent().had_edge();
  if (!hot_.empty()) keep_warm(now);
}

void Recovery::look_again(Nanoseconds at, Nanoseconds waking) noexcept {
  due_ = std::min(due_, at);
  wake_ = std::min(wake_, waking);
}

void Recovery::keep_warm(Nanoseconds now) noexcept {
  for (HotStandby& each : hot_) keep_warm(each, now);
}

// One that cannot cycle yet is looked at again, with the end of each job where that may make a gap.
void Recovery::keep_warm(HotStandby& standby, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  const TaskId id = standby.task;
  Task& task = set.tasks()[id.index];
  const bool wanted = set.standbys().keeps_warm(id);
  if (wanted == task.is_warm() || task.in_service() || task.shown_state() != State::kOff) return;
  if ((parts_.switching != nullptr && !parts_.switching->is_free()) || !parts_.signals.may_touch(id)) {
    look_again(now, now + task.spec->period);
  } else if (!wanted) {
    (void)parts_.signals.signal({&id, 1}, Signal::kOff, now);
  } else if (now < standby.again_at) {
    look_again(standby.again_at, standby.again_at);
  } else if (!gap_.is_for(task, Method::kOn, now)) {
    const Nanoseconds next = std::max(parts_.threads.next_look(now), now + Nanoseconds{1});
    look_again(gap_.is_there() ? next : now, next);
  } else if (missing_value(set, task, {}).is_valid()) {
    look_again(now + task.spec->period, now + task.spec->period);
  } else {
    parts_.signals.warm_up(id, now);
    standby.again_at = ask_again_at(task, now);
    if (task.state == State::kOff) look_again(standby.again_at, standby.again_at);
  }
}

// A switch that is not committed gives way to it; the change of one that is comes first.
bool Recovery::may_touch(Task& task) noexcept {
  const bool gives_way = parts_.switching == nullptr || parts_.switching->give_way(task.id);
  return !task.in_service() && gives_way && parts_.signals.may_touch(task.id);
}

// The task that failed, of this context, closes the resource that the next one opens. False: later.
bool Recovery::give_up_resource(std::size_t group, TaskId to, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  const TaskId failed = set.standbys().loss(group).task;
  if (!set.is_mine(failed) || !set.life().judge().rivals().are(failed, to)) return true;
  Task& task = set.tasks()[failed.index];
  if (task.in_service() || task.state != State::kError) return true;
  if (!set.is_mine(to)) {  // its context must see the ERROR first: a kill alone is no failure
    TaskId& closes = takeovers_[group].closes;
    const bool is_shown = closes == failed;  // at the end of the last cycle boundary
    closes = failed;
    if (!is_shown || !set.others()->presence(to).has_seen) {
      look_again(now + kLookForSeen, now + kLookForSeen);
      return true;
    }
  }
  if (!may_touch(task)) return false;
  takeovers_[group].closes = {};
  note(task, "is killed: its resource goes to ", to);
  (void)parts_.signals.signal({&failed, 1}, Signal::kKill, now);
  return true;
}

// False: the task is not OFF yet, and this context learns of the end of `init` or of a rival; or it is ruled out.
bool Recovery::create(std::size_t group, Task& task, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  TaskId& created = takeovers_[group].created;
  if (task.state != State::kNotCreated) return true;
  if (set.life().judge().find_rival(task.id).is_valid()) return false;
  if (created != task.id) {
    const SignalReport report = parts_.signals.signal({&task.id, 1}, Signal::kSpawn, now);
    if (report.why == Refusal::kRival) return false;  // another context is about to create one
    created = task.id;
    if (report.is_deferred) return false;
    if (task.state == State::kOff) return true;
  }
  created = {};
  rule_out(group, task, NoSwitch::kStepFailed, now);
  return false;
}

// The next one of the group is to take over.
void Recovery::rule_out(std::size_t group, Task& task, NoSwitch why, Nanoseconds now) noexcept {
  record_.begin(group, task.id);
  record_.failed(group, why, now);
  parts_.set.standbys().rule_out(task.id);
  parts_.set.on_set_changed();
}

// True: it is ON, or later, or not here; else it is ruled out.
bool Recovery::turn_on(std::size_t group, Task& task, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  Nanoseconds& again_at = takeovers_[group].again_at;
  if (task.standing == Standing::kHalfOn && now < again_at) return look_again(again_at, again_at), true;
  if (!set.life().judge().would_be_legal({&task.id, 1})) return true;  // once an input has a producer again
  const Standbys::Loss loss = set.standbys().loss(group);
  const bool was_hot = task.is_warm();
  const Nanoseconds began = set.methods().clock()->now();
  record_.begin(group, task.id);
  const SignalReport report = parts_.signals.signal({&task.id, 1}, Signal::kOn, now);
  if (report.why == Refusal::kIllegalSet) return true;  // another context turns one ON
  if (report.why == Refusal::kNotYet && now < loss.at + kReadyLimit) {
    again_at = ask_again_at(task, now);
    return look_again(again_at, again_at), true;
  }
  if (task.standing == Standing::kHalfOn) (void)parts_.signals.signal({&task.id, 1}, Signal::kOff, now);
  if (task.state == State::kOn) {
    count(task.profile.takeovers);
    note(task, "took over from ", loss.task);
    const Nanoseconds by = set.methods().clock()->now();
    if (!was_hot) record_.took(group, by - began);
    record_.done(group, by);
    if (parts_.guest != nullptr) parts_.guest->took_over(task.id, loss.task, by - loss.at, by);
    return true;
  }
  rule_out(group, task, report.why == Refusal::kNotYet ? NoSwitch::kNotReady : NoSwitch::kOnFailed, now);
  return false;
}

// False: later.
bool Recovery::take_over(std::size_t group, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  for (;;) {
    const TaskId id = set.standbys().next(group);
    if (!id.is_valid()) {
      takeovers_[group] = {};  // of a loss that was made good, or given up
      return true;
    }
    if (!give_up_resource(group, id, now)) return false;
    if (!set.is_mine(id) || set.tasks()[id.index].in_service()) return true;
    Task& task = set.tasks()[id.index];
    if (!may_touch(task)) return false;
    if (!create(group, task, now)) {
      if (set.standbys().next(group) == id) return true;
      continue;
    }
    takeovers_[group].created = {};
    if (turn_on(group, task, now)) return true;
  }
}

// False: later.
bool Recovery::restart(Restart& each, Nanoseconds now) noexcept {
  Task& task = parts_.set.tasks()[each.spec->task.index];
  if (task.state != State::kError) each.is_answered = false;
  while (task.state == State::kError && !each.is_answered) {
    if (parts_.set.standbys().is_awaited(task.id) || !may_touch(task)) return false;
    answer(each, task, now);
  }
  return true;
}

void Recovery::answer(Restart& each, Task& task, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  const TaskId id = task.id;
  const bool is_replaced = set.standbys().is_replaced(id);
  if (now - each.last >= each.spec->within) each.n = 0;
  if (each.n < each.spec->most && (is_replaced || set.life().judge().would_be_legal({&id, 1}))) {
    ++each.n;
    each.last = now;
    count(task.profile.restarts);
    (void)parts_.signals.signal({&id, 1}, Signal::kClear, now);
    if (task.state == State::kOff && is_replaced) return note(task, "is cleared; it stays OFF beside its standby", {});
    const bool is_cleared = task.state == State::kOff;
    if (is_cleared) (void)parts_.signals.signal({&id, 1}, Signal::kOn, now);
    if (task.state == State::kOn) return note(task, "restarted after a fault", {});
    if (is_cleared && task.state == State::kError) return;  // on failed: another fault
  }
  each.is_answered = true;
  parts_.settlement.react_to_fault(task, each.spec->then, now);
}

void Recovery::note(Task& task, const char* what, TaskId of) noexcept {
  Message message(what);
  if (of.is_valid()) message << "'" << parts_.set.spec().tasks[of.index].name << "'";
  record_note(task, FixedString<CHIMERA_FAULT_TEXT - 1>(message.view()).c_str());
  parts_.settlement.record_faults(task);
}

}  // namespace chimera
