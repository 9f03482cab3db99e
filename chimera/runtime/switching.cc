// SPDX-License-Identifier: Apache-2.0
// Carries out the plan of a switch: arms, commits at one instant, turns OFF, and writes the receipt.
#include "chimera/runtime/switching.h"

#include <algorithm>
#include <cstring>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

// A method that was never called is taken to need the budget of the task; without one, so long.
constexpr Nanoseconds kUnknownMethod = microseconds(100);

bool is_periodic(const Task& task) noexcept { return !task.spec->aperiodic; }

}  // namespace

void Switching::prepare(std::size_t n_switches) {
  if (n_switches == 0) return;
  const ApplicationSpec& spec = parts_.set.spec();
  SetupMemory& memory = parts_.set.setup_memory();
  planner_.prepare(spec, memory);
  receipts_.prepare(spec, n_switches, memory);
  standing_ = memory.take<TaskStanding>(spec.tasks.size());
  before_ = memory.take<std::uint64_t>(spec.tasks.size());
  cycles_ = memory.take<std::uint64_t>(spec.tasks.size());
  has_last_ = memory.take<bool>(spec.variables.size());
  last_ = memory.take<std::span<std::byte>>(spec.variables.size());
  for (std::size_t v = 0; v < spec.variables.size(); ++v) {
    std::size_t most = 0;
    for (const PortOf& producer : spec.variables[v].producers)
      most = std::max<std::size_t>(most, parts_.set.memory(producer.task).output_spec(producer.index)->max_bytes());
    last_[v] = memory.take_bytes(most, alignof(double));
  }
}

void Switching::ask(std::uint32_t set, Nanoseconds now) noexcept {
  const bool only_watches = phase_ == Phase::kAfter && n_off_ == plan_.leaving.size();
  if (only_watches) finish(SwitchEnd::kDone, now);
  SwitchReceipt& receipt = receipts_.add();
  receipt.asked = now;
  receipt.after = set;
  for (const Task& each : parts_.set.tasks()) standing_[each.id.index] = {each.state, each.in_service};
  PlanAnswer answer{NoSwitch::kUnderWay, {}};
  if (phase_ == Phase::kNone) answer = planner_.plan(set, standing_, plan_);
  receipt.before = planner_.set_in_force(standing_);
  if (answer.why != NoSwitch::kNothingToDo) receipt.number = ++n_asked_;
  if (!answer) {
    receipt.end = answer.why == NoSwitch::kNothingToDo ? SwitchEnd::kNothingToDo : SwitchEnd::kRefused;
    receipt.why = answer.why;
    receipt.task = answer.task;
    receipt.tasks = {};
    receipt.variables = {};
    return;
  }
  plan_.number = receipt.number;
  receipt_ = &receipt;
  plan_parts();
  was_raised_ = parts_.set.flag().is_raised();
  n_armed_ = n_off_ = 0;
  phase_ = Phase::kArming;
  due_ = now;
}

void Switching::plan_parts() noexcept {
  std::size_t n = 0;
  const auto add = [&](std::span<const TaskId> ids, TaskMove move) {
    for (const TaskId id : ids) {
      receipt_->tasks[n++] = {id, move, Nanoseconds{-1}, Nanoseconds{-1}, 0};
      before_[id.index] = losses(id);
    }
  };
  add(plan_.arriving, TaskMove::kArrives);
  add(plan_.leaving, TaskMove::kLeaves);
  add(plan_.staying, TaskMove::kStays);
  receipt_->tasks = receipt_->tasks.first(n);
  receipt_->variables = receipt_->variables.first(plan_.handovers.size());
  for (std::size_t h = 0; h < plan_.handovers.size(); ++h) receipt_->variables[h] = {plan_.handovers[h], {}, {}};
}

void Switching::step(Nanoseconds now) noexcept {
  if (phase_ == Phase::kNone || now < due_) return;
  if (phase_ == Phase::kArming) arm_all(now);
  if (phase_ == Phase::kArming) return;
  now = parts_.clock.now();
  if (phase_ == Phase::kAfter) look_at_first_cycles();
  if (!turn_off_all(now, false)) return wait(now);
  now = parts_.clock.now();
  if (phase_ == Phase::kUndoing) return finish(SwitchEnd::kAborted, now);
  if (has_seen_first_cycles() || now >= first_cycles_by_) return finish(SwitchEnd::kDone, now);
  due_ = now;
  wake_ = first_cycles_by_;
}

void Switching::arm_all(Nanoseconds now) noexcept {
  if (!may_go_on(now)) return;
  while (n_armed_ < plan_.arriving.size()) {
    Task& next = task(plan_.arriving[n_armed_]);
    if (!is_idle() || !has_gap(next, Method::kOn, now)) return wait(now);
    parts_.set.sources().read_ahead(next.id, plan_.handovers);
    if (lacks_value(next).is_valid()) return wait(now);
    if (!arm(next, now)) return;
    now = parts_.clock.now();
    receipt_->armed = now;
  }
  // A release before `now` belongs to the time before the change: its job comes first.
  if (!is_idle() || parts_.queue.next_release() < now) return wait(now);
  if (judge_steps()) commit(now);
}

// Whoever takes part is as the plan found it, and there is still time; else the switch is aborted.
bool Switching::may_go_on(Nanoseconds now) noexcept {
  const auto moved = [&](TaskId id, bool is_well) {
    if (!is_well) abort(NoSwitch::kDisturbed, id, {});
    return !is_well;
  };
  for (std::size_t i = 0; i < plan_.arriving.size(); ++i) {
    const Task& each = task(plan_.arriving[i]);
    const bool is_off = each.state == State::kOff && !each.in_service;
    if (moved(each.id, is_off && each.owes_off == (i < n_armed_))) return false;
  }
  for (const auto ids : {plan_.leaving, plan_.staying})
    for (const TaskId id : ids)
      if (moved(id, task(id).state == State::kOn)) return false;
  if (parts_.set.flag().is_raised() && !was_raised_) {
    abort(NoSwitch::kFlagRaised, parts_.set.flag().raised_by(), {});
    return false;
  }
  if (now < receipt_->asked + kPatience) return true;
  if (n_armed_ == plan_.arriving.size()) {
    abort(NoSwitch::kNoGap, {}, {});
    return false;
  }
  Task& next = task(plan_.arriving[n_armed_]);
  parts_.set.sources().read_ahead(next.id, plan_.handovers);
  const VariableId missing = lacks_value(next);
  abort(missing.is_valid() ? NoSwitch::kNoValue : NoSwitch::kNoGap, next.id, missing);
  return false;
}

bool Switching::has_gap(const Task& task, Method method, Nanoseconds now) const noexcept {
  const Spread& measured = task.profile.execution[static_cast<int>(method)];
  const Nanoseconds guess = task.spec->budget > Nanoseconds{} ? task.spec->budget : kUnknownMethod;
  const Nanoseconds need = measured.count == 0 ? guess : measured.max + Nanoseconds{measured.max.count / 5};
  return parts_.queue.next_release() - now >= need;
}

// The first variable that the task reads and that never had a value; what an arriving task will write is not asked for.
VariableId Switching::lacks_value(Task& task) noexcept {
  read_inputs(task);
  const TaskMemory& memory = parts_.set.memory(task.id);
  for (std::size_t i = 0; i < task.inputs.size(); ++i) {
    const VariableId variable = memory.input_spec(i).variable;
    const auto is_its = [&](const Handover& handover) { return handover.variable == variable; };
    if (std::any_of(plan_.handovers.begin(), plan_.handovers.end(), is_its)) continue;
    const chimera_port& port = *task.inputs[i].port;
    if (((port.slot->valid >> port.bit) & 1u) == 0) return variable;
  }
  return {};
}

bool Switching::arm(Task& next, Nanoseconds now) noexcept {
  const Nanoseconds began = parts_.clock.now();
  const SignalReport report = parts_.set.life().arm(next.id, now);
  parts_.tap.record(TapKind::kSignal, now, next.id, static_cast<std::uint64_t>(Signal::kOn), report ? 1 : 0);
  parts_.settlement.record_faults(next);
  part_of(next.id).on = parts_.clock.now() - began;
  if (report) ++n_armed_;
  else abort(NoSwitch::kOnFailed, next.id, {});
  if (!report) receipt_->said.assign(next.faults.last.text);
  return static_cast<bool>(report);
}

// Keeps the last value of each variable that is handed over, and holds what `on` wrote against it.
bool Switching::judge_steps() noexcept {
  for (VariablePart& part : receipt_->variables) {
    const Handover& handover = part.handover;
    const std::size_t v = handover.variable.index;
    const Source& source = parts_.set.sources().source(handover.variable);
    const chimera_slot* slot = parts_.set.sources().latest(handover.variable);
    has_last_[v] = handover.from.task.is_valid() && slot != nullptr && ((slot->valid >> source.bit) & 1u) != 0;
    if (!has_last_[v]) continue;
    const PortSpec& spec = *parts_.set.memory(handover.from.task).output_spec(handover.from.index);
    std::memcpy(last_[v].data(), reinterpret_cast<const std::byte*>(slot + 1) + source.offset, spec.max_bytes());
    part.step_of_on = step_to(handover);
    if (!part.step_of_on.is_beyond) continue;
    abort(NoSwitch::kStepTooLarge, handover.to.task, handover.variable);
    return false;
  }
  return true;
}

// From the last value of the producer before to the latest of the one after.
ValueStep Switching::step_to(const Handover& handover) noexcept {
  const Task& producer = task(handover.to.task);
  const chimera_slot* slot = producer.group.published();
  if (!has_last_[handover.variable.index] || ((slot->valid >> handover.to.index) & 1u) == 0) return {};
  const TaskMemory& memory = parts_.set.memory(producer.id);
  const PortSpec& spec = *memory.output_spec(handover.to.index);
  const auto* values = reinterpret_cast<const std::byte*>(slot + 1) + memory.output_offset(handover.to.index);
  return step_between(spec, producer.component->ports[spec.declared], memory.output_port(handover.to.index)->count,
                      last_[handover.variable.index].data(), values);
}

void Switching::commit(Nanoseconds at) noexcept {
  TaskSet& set = parts_.set;
  const bool was_illegal = set.flag().is_up();
  for (const TaskId id : plan_.leaving) {
    Task& leaving = task(id);
    leaving.state = State::kOff;
    leaving.owes_off = true;
    part_of(id).lost = losses(id) - before_[id.index];
  }
  first_cycles_by_ = at;
  for (const TaskId id : plan_.arriving) {
    Task& arriving = task(id);
    arriving.state = State::kOn;
    arriving.owes_off = false;
    set.sources().take_outputs_of(arriving);
    before_[id.index] = losses(id);
    cycles_[id.index] = arriving.profile.cycles;
    if (is_periodic(arriving))
      first_cycles_by_ = std::max(first_cycles_by_, at + arriving.spec->period + arriving.spec->deadline);
  }
  set.on_set_changed();
  if (set.flag().is_up() != was_illegal) parts_.tap.record(TapKind::kFlag, at, TaskId(), was_illegal ? 0 : 1);
  for (const TaskId id : plan_.leaving) parts_.members.follow(task(id), at);
  for (const TaskId id : plan_.arriving) {
    parts_.members.follow(task(id), at);
    set.sent().deliver(task(id));
  }
  receipt_->at = at;
  phase_ = Phase::kAfter;
}

void Switching::abort(NoSwitch why, TaskId of, VariableId variable) noexcept {
  receipt_->why = why;
  receipt_->task = of;
  receipt_->variable = variable;
  for (const TaskId id : plan_.arriving)
    if (task(id).owes_off) task(id).outbox.clear();
  phase_ = Phase::kUndoing;
}

// `off` of those that left, or were armed in vain, each in a gap unless it is to be at once. False: some are left for
// the next gap.
bool Switching::turn_off_all(Nanoseconds now, bool at_once) noexcept {
  const bool undoes = phase_ == Phase::kUndoing;
  const std::size_t n = undoes ? n_armed_ : plan_.leaving.size();
  const Nanoseconds since = undoes ? receipt_->asked + kPatience : receipt_->at;
  for (; n_off_ < n; ++n_off_) {
    Task& next = task(undoes ? plan_.arriving[n - 1 - n_off_] : plan_.leaving[n_off_]);
    if (!next.owes_off) continue;  // a signal that came before had it turned off
    const bool may_wait = !at_once && now < since + kPatience;
    if (may_wait && (!is_idle() || !has_gap(next, Method::kOff, now))) return false;
    const Nanoseconds began = parts_.clock.now();
    const SignalReport report = parts_.set.life().settle_off(next.id, now);
    now = parts_.clock.now();
    parts_.tap.record(TapKind::kSignal, began, next.id, static_cast<std::uint64_t>(Signal::kOff), report ? 1 : 0);
    parts_.settlement.record_faults(next);
    part_of(next.id).off = now - began;
  }
  return true;
}

void Switching::look_at_first_cycles() noexcept {
  for (VariablePart& part : receipt_->variables) {
    const Task& producer = task(part.handover.to.task);
    if (part.step_of_cycle.is_known || producer.profile.cycles == cycles_[producer.id.index]) continue;
    part.step_of_cycle = step_to(part.handover);
  }
}

bool Switching::has_seen_first_cycles() noexcept {
  return std::all_of(plan_.arriving.begin(), plan_.arriving.end(), [this](TaskId id) {
    return !is_periodic(task(id)) || task(id).profile.cycles > cycles_[id.index] || task(id).state != State::kOn;
  });
}

void Switching::finish(SwitchEnd end, Nanoseconds now) noexcept {
  receipt_->end = end;
  receipt_->ended = now;
  const bool was_committed = end == SwitchEnd::kDone;
  for (TaskPart& part : receipt_->tasks) {
    const bool was_on = part.move == TaskMove::kStays || (part.move == TaskMove::kArrives) == was_committed;
    if (was_on) part.lost = losses(part.task) - before_[part.task.index];
  }
  if (!was_committed)
    for (const TaskId id : plan_.arriving)
      if (task(id).state != State::kNotCreated) parts_.set.sources().read_ahead(id, {});
  phase_ = Phase::kNone;
  due_ = wake_ = kNever;
}

void Switching::end(Nanoseconds now) noexcept {
  if (phase_ == Phase::kNone) return;
  if (phase_ == Phase::kArming) abort(NoSwitch::kRunEnded, {}, {});
  const bool was_committed = phase_ == Phase::kAfter;
  if (was_committed) look_at_first_cycles();
  (void)turn_off_all(now, true);
  finish(was_committed ? SwitchEnd::kDone : SwitchEnd::kAborted, parts_.clock.now());
}

// No job is under way, and none that was released waits.
bool Switching::is_idle() const noexcept {
  const auto is_busy = [](const Task& each) { return each.is_busy; };
  const auto tasks = parts_.set.tasks();
  return parts_.queue.is_empty() && std::none_of(tasks.begin(), tasks.end(), is_busy);
}

// The next step is worth while when jobs have ended, or at the next release where the processor is idle.
void Switching::wait(Nanoseconds now) noexcept {
  const Nanoseconds limit = std::max(receipt_->asked + kPatience, now + Nanoseconds{1});
  const Nanoseconds next = std::max(parts_.queue.next_release(), now);
  wake_ = std::min(next, limit);
  due_ = is_idle() ? wake_ : now;
}

TaskPart& Switching::part_of(TaskId id) noexcept {
  const auto is_its = [id](const TaskPart& part) { return part.task == id; };
  return *std::find_if(receipt_->tasks.begin(), receipt_->tasks.end(), is_its);
}

std::uint64_t Switching::losses(TaskId id) noexcept {
  const Profile& profile = task(id).profile;
  return profile.dropped + profile.aborted;
}

}  // namespace chimera
