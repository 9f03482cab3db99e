// SPDX-License-Identifier: Apache-2.0
// Measures the switch that is under way.
#include "chimera/runtime/switch/switch_record.h"

#include <algorithm>
#include <cstring>

#include "chimera/task/number_at.h"

namespace chimera {
namespace {

std::uint32_t bytes_of(const ApplicationSpec& spec, const PortOf& output) noexcept {
  const PortSpec* port = spec.port(CHIMERA_OUT_VAR, output);
  return port == nullptr ? 0 : port->max_bytes();
}

bool is_number(std::uint32_t type) noexcept { return type <= CHIMERA_FLOAT64; }

double distance(double a, double b) noexcept { return a < b ? b - a : a - b; }

// Three values of one element: before, after, and its limit; null if it has none.
struct Place3 {
  const std::byte *before, *after, *limit;

  Place3 behind(std::size_t bytes) const noexcept {
    return {before + bytes, after + bytes, limit == nullptr ? nullptr : limit + bytes};
  }
};

void compare(ValueStep& found, std::uint32_t type, const Place3& at) noexcept {
  if (!is_number(type)) return;
  const double size = distance(number_at(type, at.before), number_at(type, at.after));
  const double limit = at.limit == nullptr ? 0 : number_at(type, at.limit);
  const bool is_beyond = limit > 0 && !(size <= limit);
  const double share = limit > 0 ? size / limit : size;
  const double before = found.limit > 0 ? found.size / found.limit : found.size;
  // An element beyond its limit goes before one within its limit. NaN is beyond every limit.
  const bool is_farther = is_beyond != found.is_beyond ? is_beyond : !(share <= before);
  if (!found.is_known || is_farther) {
    found.size = size;
    found.limit = limit;
  }
  found.is_known = true;
  found.is_beyond = found.is_beyond || is_beyond;
}

}  // namespace

ValueStep step_between(const PortSpec& port, const DeclaredPort& declared, std::uint32_t count,
                       const std::byte* before, const std::byte* after) noexcept {
  ValueStep found;
  const Place3 begin{before, after, port.max_step.empty() ? nullptr : port.max_step.data()};
  for (std::uint32_t e = 0; e < count; ++e) {
    const Place3 element = begin.behind(std::size_t{e} * port.element_bytes);
    if (port.type != CHIMERA_STRUCT) {
      compare(found, port.type, element);
      continue;
    }
    for (std::uint32_t f = 0; f < declared.n_fields(); ++f) {
      const FieldForm field = declared.field(f);
      for (std::uint32_t i = 0; i < field.count; ++i)
        compare(found, field.type, element.behind(field.offset + std::size_t{i} * field.size));
    }
  }
  return found;
}

void HandoverSteps::prepare() {
  const ApplicationSpec& spec = set_.spec();
  SetupMemory& memory = set_.setup_memory();
  has_last_ = memory.take<bool>(spec.variables.size());
  last_ = memory.take<std::span<std::byte>>(spec.variables.size());
  watched_ = memory.take<std::span<std::byte>>(spec.variables.size());
  watched_sequence_ = memory.take<std::uint64_t>(spec.variables.size());
  for (std::size_t v = 0; v < spec.variables.size(); ++v) {
    std::uint32_t most = 0;
    for (const PortOf& producer : spec.variables[v].producers) most = std::max(most, bytes_of(spec, producer));
    last_[v] = memory.take_bytes(most, alignof(double));
    watched_[v] = memory.take_bytes(most, alignof(double));
  }
}

void HandoverSteps::keep_last(std::span<const VariablePart> variables) noexcept {
  for (const VariablePart& part : variables) {
    const Source& source = set_.sources().source(part.handover.variable);
    has_last_[part.handover.variable.index] = false;
    if (!part.handover.from.task.is_valid()) continue;
    keep(part.handover, set_.sources().latest(part.handover.variable), source.offset, source.bit);
  }
}

void HandoverSteps::keep_last_of(const Handover& handover) noexcept {
  const Task& producer = set_.tasks()[handover.from.task.index];
  const std::uint32_t offset = set_.memory(producer.id).output_offset(handover.from.index);
  keep(handover, producer.group.published(), offset, handover.from.index);
}

void HandoverSteps::keep(const Handover& handover, const chimera_slot* slot, std::uint32_t offset,
                         std::uint32_t bit) noexcept {
  const std::span<std::byte> last = last_[handover.variable.index];
  has_last_[handover.variable.index] = slot != nullptr && ((slot->valid >> bit) & 1u) != 0;
  if (!has_last_[handover.variable.index]) return;
  std::memcpy(last.data(), reinterpret_cast<const std::byte*>(slot + 1) + offset, bytes_of(set_.spec(), handover.from));
}

void HandoverSteps::begin_watch() noexcept {
  std::fill(watched_sequence_.begin(), watched_sequence_.end(), std::uint64_t{0});
}

void HandoverSteps::keep_watched(const Handover& handover) noexcept {
  const std::size_t v = handover.variable.index;
  if (watched_sequence_[v] == 0) return;
  std::memcpy(last_[v].data(), watched_[v].data(), bytes_of(set_.spec(), handover.from));
  has_last_[v] = true;
}

// The step of `off` is none of its cycles.
void HandoverSteps::watch(std::span<VariablePart> variables) noexcept {
  for (VariablePart& part : variables) {
    const Handover& handover = part.handover;
    const TaskId from = handover.from.task;
    if (!set_.is_mine(handover.to.task) || !from.is_valid()) continue;
    const bool is_on = (set_.is_mine(from) ? set_.tasks()[from.index].state : set_.others()->state(from)) == State::kOn;
    const Source& source = set_.sources().source(handover.variable);
    const chimera_slot* const slot = set_.sources().latest(handover.variable);
    std::uint64_t& seen = watched_sequence_[handover.variable.index];
    if (!is_on || slot == nullptr || ((slot->valid >> source.bit) & 1u) == 0 || slot->sequence == seen) continue;
    const std::byte* const value = reinterpret_cast<const std::byte*>(slot + 1) + source.offset;
    const std::span<std::byte> before = watched_[handover.variable.index];
    const ValueStep step = this->step(handover, before.data(), value);
    if (seen != 0 && slot->sequence == seen + 1 && step.is_known && !(step.size <= part.usual.size)) part.usual = step;
    if (seen != 0 && slot->sequence == seen + 1 && step.is_known) part.usual.is_known = true;
    seen = slot->sequence;
    std::memcpy(before.data(), value, bytes_of(set_.spec(), handover.from));
  }
}

ValueStep HandoverSteps::step(const Handover& handover, const std::byte* from, const std::byte* to) const noexcept {
  const Task& producer = set_.tasks()[handover.to.task.index];
  const TaskMemory& memory = set_.memory(producer.id);
  const chimera_port* const port = memory.output_port(handover.to.index);
  if (port == nullptr) return {};  // it is not created yet
  const PortSpec& spec = *memory.output_spec(handover.to.index);
  return step_between(spec, producer.ports[spec.declared], port->count, from, to);
}

ValueStep HandoverSteps::step_to(const Handover& handover) noexcept {
  const Task& producer = set_.tasks()[handover.to.task.index];
  const chimera_slot* slot = producer.group.published();
  if (!has_last_[handover.variable.index] || ((slot->valid >> handover.to.index) & 1u) == 0) return {};
  const std::uint32_t offset = set_.memory(producer.id).output_offset(handover.to.index);
  return step(handover, last_[handover.variable.index].data(), reinterpret_cast<const std::byte*>(slot + 1) + offset);
}

Nanoseconds StartDelays::begin(const Task& task) noexcept {
  const Spread now = seen_[task.id.index] = task.profile.start_delay;
  return now.count == 0 ? Nanoseconds{-1} : now.max;
}

Nanoseconds StartDelays::look(const Task& task) noexcept {
  Spread& seen = seen_[task.id.index];
  if (seen.count == kNotBegun) return (void)begin(task), Nanoseconds{-1};
  const Spread before = seen, now = seen = task.profile.start_delay;
  if (now.count <= before.count) return Nanoseconds{-1};  // spawned anew: it begins at 0
  if (before.count == 0 || now.max > before.max) return now.max;
  return Nanoseconds{(now.sum - before.sum).count / static_cast<std::int64_t>(now.count - before.count)};
}

void SwitchRecord::prepare() {
  const ApplicationSpec& spec = set_.spec();
  receipts_.prepare(spec, 1, set_.setup_memory());
  before_ = set_.setup_memory().take<std::uint64_t>(spec.tasks.size());
  cycles_ = set_.setup_memory().take<std::uint64_t>(spec.tasks.size());
  steps_.prepare();
  delays_.prepare(spec.tasks.size(), set_.setup_memory());
}

SwitchReceipt& SwitchRecord::restart() noexcept {
  receipts_.clear();
  return *(receipt_ = &receipts_.add());
}

void SwitchRecord::take_up(const SwitchPlan& plan) noexcept {
  first_cycles_by_ = kNever;
  std::size_t n = 0;
  receipt_->reinitialised = receipt_->reinitialised.first(0);
  const auto list = [&](std::span<const TaskId> ids, TaskMove move) {
    for (const TaskId id : ids) {
      TaskPart& part = receipt_->tasks.data()[n++];
      part = {};
      part.task = id;
      part.move = move;
      if (set_.tasks()[id.index].is_busy) delays_.begin_later(id);
      else part.delay_before = delays_.begin(set_.tasks()[id.index]);
      before_[id.index] = losses(id);
    }
  };
  list(plan.arriving, TaskMove::kArrives);
  list(plan.leaving, TaskMove::kLeaves);
  list(plan.staying, TaskMove::kStays);
  receipt_->tasks = {receipt_->tasks.data(), n};
  receipt_->variables = {receipt_->variables.data(), plan.handovers.size()};
  for (std::size_t h = 0; h < plan.handovers.size(); ++h) receipt_->variables[h] = {plan.handovers[h], {}, {}, {}};
  steps_.begin_watch();
}

// A task with a job under way is looked at when that has ended.
void SwitchRecord::watch() noexcept {
  for (TaskPart& part : receipt_->tasks) {
    const Task& task = set_.tasks()[part.task.index];
    if (set_.is_mine(part.task) && !task.is_busy) part.delay = std::max(part.delay, delays_.look(task));
  }
  if (receipt_->at == kNever) steps_.watch(receipt_->variables);
}

void SwitchRecord::took(TaskId task, Method method, Nanoseconds time) noexcept {
  TaskPart& part = part_of(task);
  (method == Method::kOn ? part.on : part.off) = time;
}

const VariablePart* SwitchRecord::find_too_large_step() noexcept {
  steps_.keep_last(receipt_->variables);
  for (VariablePart& part : receipt_->variables) {
    if (!set_.is_mine(part.handover.to.task)) continue;
    part.step_of_on = steps_.step_to(part.handover);
    if (part.step_of_on.is_beyond) return &part;
  }
  return nullptr;
}

void SwitchRecord::leaves(TaskId task) noexcept {
  part_of(task).lost = losses(task) - before_[task.index];
  for (const VariablePart& part : receipt_->variables)
    if (part.handover.from.task == task) steps_.keep_last_of(part.handover);
}

const VariablePart* SwitchRecord::arrives(TaskId id, Nanoseconds now) noexcept {
  follow_arrival(id, now);
  const VariablePart* found = nullptr;
  for (VariablePart& part : receipt_->variables) {
    if (part.handover.to.task != id) continue;
    const TaskId from = part.handover.from.task;
    if (from.is_valid() && !set_.is_mine(from)) steps_.keep_watched(part.handover);
    part.step_of_on = steps_.step_to(part.handover);
    if (part.step_of_on.is_beyond && found == nullptr) found = &part;
  }
  return found;
}

// A task that is re-initialised again on the way back is not listed again.
void SwitchRecord::reinitialised(TaskId task) noexcept {
  const std::span<TaskId> list = receipt_->reinitialised;
  if (std::find(list.begin(), list.end(), task) == list.end()) append(receipt_->reinitialised, task);
}

// Losses and first cycles of an arriving task count from here.
void SwitchRecord::follow_arrival(TaskId id, Nanoseconds at) noexcept {
  const Task& arriving = set_.tasks()[id.index];
  before_[id.index] = losses(id);
  cycles_[id.index] = arriving.profile.cycles;
  if (first_cycles_by_ == kNever) first_cycles_by_ = at;
  if (!arriving.spec->aperiodic) first_cycles_by_ = std::max(first_cycles_by_, first_cycle_by(*arriving.spec, at));
}

void SwitchRecord::changed(const SwitchPlan& plan, Nanoseconds at) noexcept {
  receipt_->at = first_cycles_by_ = at;
  steps_.keep_last(receipt_->variables);
  for (const TaskId id : plan.leaving) part_of(id).lost = losses(id) - before_[id.index];
  for (const TaskId id : plan.arriving)
    if (set_.is_mine(id)) follow_arrival(id, at);
}

// A task with a job under way may be publishing: it is looked at when the job has ended.
void SwitchRecord::keep_last_of_leaving() noexcept {
  for (const VariablePart& part : receipt_->variables) {
    const TaskId from = part.handover.from.task;
    if (from.is_valid() && set_.is_mine(from) && !set_.tasks()[from.index].is_busy) steps_.keep_last_of(part.handover);
  }
}

bool SwitchRecord::has_cycled(TaskId id) const noexcept {
  const Task& arriving = set_.tasks()[id.index];
  return !arriving.is_busy && arriving.profile.cycles != cycles_[id.index];
}

bool SwitchRecord::is_awaited(const TaskPart& part) const noexcept {
  const Task& task = set_.tasks()[part.task.index];
  return part.move == TaskMove::kArrives && set_.is_mine(part.task) && !task.spec->aperiodic &&
         task.state == State::kOn && !has_cycled(part.task);
}

void SwitchRecord::await_first_cycles(JobThreads& threads) noexcept {
  for (const TaskPart& part : receipt_->tasks)
    if (is_awaited(part)) threads.await_job(part.task);
}

bool SwitchRecord::has_seen_first_cycles(Nanoseconds now) noexcept {
  for (VariablePart& part : receipt_->variables) {
    const TaskId to = part.handover.to.task;
    if (!set_.is_mine(to) || part.step_of_cycle.is_known) continue;
    if (!has_cycled(to)) continue;
    part.step_of_cycle = steps_.step_to(part.handover);
  }
  const auto waits = [this](const TaskPart& part) { return is_awaited(part); };
  return now >= first_cycles_by_ || std::none_of(receipt_->tasks.begin(), receipt_->tasks.end(), waits);
}

void SwitchRecord::end(SwitchEnd end, Nanoseconds now) noexcept {
  watch();
  receipt_->end = end;
  receipt_->ended = now;
  const bool was_committed = end == SwitchEnd::kDone;
  for (TaskPart& part : receipt_->tasks) {
    const bool was_on = part.move == TaskMove::kStays || (part.move == TaskMove::kArrives) == was_committed;
    if (was_on) part.lost = losses(part.task) - before_[part.task.index];
  }
}

TaskPart& SwitchRecord::part_of(TaskId id) noexcept {
  const auto is_its = [id](const TaskPart& part) { return part.task == id; };
  return *std::find_if(receipt_->tasks.begin(), receipt_->tasks.end(), is_its);
}

}  // namespace chimera
