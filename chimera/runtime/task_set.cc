// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/task_set.h"

#include <algorithm>
#include <cstring>

namespace chimera {

const chimera_host TaskSet::kHost = {&TaskSet::host_expired, &TaskSet::host_signal,   &TaskSet::host_spend,
                                     &TaskSet::host_note,    &TaskSet::host_variable, &TaskSet::host_unit};

Result<std::unique_ptr<TaskSet>> TaskSet::create(const ApplicationSpec& spec,
                                                 std::span<const chimera_component* const> components,
                                                 const ContextPlace& place) {
  CHIMERA_ASSERT(components.size() == spec.tasks.size());
  std::unique_ptr<TaskSet> made(new TaskSet(spec, place));
  if (auto built = made->build(components); !built) return built.error();
  return made;
}

TaskSet::~TaskSet() {
  for (std::size_t t = 0; t < memories_.size(); ++t) {
    if (!memories_[t].is_planned()) continue;
    (void)end_background(tasks_[t], {});
    memories_[t].destroy(tasks_[t]);
  }
}

Result<void> TaskSet::build(std::span<const chimera_component* const> components) {
  const std::size_t n = spec_.tasks.size();
  memories_.reserve(n);
  for (std::size_t t = 0; t < n; ++t) {
    if (place_.rtpu.is_valid() && spec_.tasks[t].rtpu != place_.rtpu) {
      memories_.emplace_back();
      continue;
    }
    auto memory = TaskMemory::create(spec_.tasks[t], *components[t]);
    if (!memory) return memory.error();
    memories_.push_back(*std::move(memory));
  }
  variables_ = std::make_unique<Variables>(spec_);
  tasks_.resize(n);
  contexts_.resize(n);
  serving_.resize(n);
  on_.assign(n, false);
  raises_.assign(n, false);
  wanted_.assign(n, false);
  for (std::size_t t = 0; t < n; ++t) prepare_task(t);
  for (std::size_t t = 0; t < n; ++t) tasks_[t].component = components[t];
  for (const Variable& variable : variables_->all()) {
    if (!variable.producers.empty() || variable.operator_index != UINT32_MAX) continue;
    const std::string_view reader = spec_.tasks[variable.consumers[0].task.index].name;
    return Error{ErrorCode::kBadInput, {"nobody produces state variable " + std::string(variable.name)}, {reader}};
  }
  if (auto laid = lay_out(); !laid) return laid;
  set_constants();
  plan_foreign_constants();
  place_operators();
  bindings_.prepare(*variables_, *everything_, tasks_, memories_, operators_, place_.others,
                    place_.preemptive);
  return {};
}

void TaskSet::prepare_task(std::size_t t) {
  Task& task = tasks_[t];
  task.spec = &spec_.tasks[t];
  task.id = TaskId(t);
  contexts_[t] = {this, &task, nullptr};
  task.call.fault = &task.said;
  task.call.host = &kHost;
  task.call.context = &contexts_[t];
  task.inputs = memories_[t].inputs();
  task.running = place_.running;
}

Result<void> TaskSet::lay_out() {
  auto everything = PeerLayout::of_everything(spec_);
  if (!everything) return everything.error();
  everything_ = std::make_unique<PeerLayout>(*std::move(everything));
  if (place_.rtpu.is_valid()) {
    auto own = PeerLayout::of(spec_, place_.rtpu.index);
    if (!own) return own.error();
    layout_ = std::make_unique<PeerLayout>(*std::move(own));
  } else {
    layout_ = std::make_unique<PeerLayout>(*everything_);
  }
  if (place_.table.empty()) own_table_ = AlignedBytes(layout_->table().region_bytes(), kCacheLine);
  table_ = place_.table.empty() ? own_table_.span() : place_.table;
  CHIMERA_ASSERT(table_.size() >= layout_->table().region_bytes());
  for (std::size_t t = 0; t < memories_.size(); ++t) {
    if (!memories_[t].is_planned()) continue;
    const GroupId first = layout_->outputs(TaskId(t), 0), second = layout_->outputs(TaskId(t), 1);
    memories_[t].place(group_memory(first), group_memory(second), layout_->place(first).payload_bytes,
                       layout_->variables(first));
  }
  return {};
}

std::span<std::byte> TaskSet::group_memory(GroupId group) const noexcept {
  const GroupPlace& place = layout_->place(group);
  return table_.subspan(place.offset, group_bytes(place.payload_bytes));
}

void TaskSet::set_constants() {
  for (const TaskSpec& task : spec_.tasks)
    for (const PortSpec& port : task.ports)
      if ((port.kind == CHIMERA_IN_CONST || port.kind == CHIMERA_OUT_CONST) && !port.variable.empty())
        constants_.declare(port.variable, port.type, port.max_bytes());
  for (const GivenSpec& given : spec_.constants) {
    constants_.declare(given.name, given.type, given.value.size());
    constants_.set(given.name, given.value, TaskId{});
  }
}

void TaskSet::plan_foreign_constants() {
  std::uint32_t largest = 0;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    if (memories_[t].is_planned()) continue;
    const GroupId group = everything_->constants(TaskId(t));
    largest = std::max(largest, everything_->place(group).payload_bytes);
    std::size_t i = 0;
    for (const PortSpec& port : spec_.tasks[t].ports) {
      if (port.kind != CHIMERA_OUT_CONST) continue;
      foreign_constants_.push_back(
          {TaskId(t), port.variable, everything_->variables(group)[i].offset, port.max_bytes()});
      ++i;
    }
  }
  constant_scratch_ = AlignedBytes(largest, kCacheLine);
}

void TaskSet::place_operators() {
  if (place_.rtpu.is_valid()) return;  // they are the manager's
  for (std::size_t o = 0; o < spec_.operators.size(); ++o) {
    const GroupId group = layout_->operator_group(o);
    set_operator(o, spec_.operators[o].value, Nanoseconds{});
    operators_.emplace_back(group_memory(group).data(), layout_->place(group).payload_bytes);
  }
}

void TaskSet::set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept {
  CHIMERA_ASSERT(!place_.rtpu.is_valid() && value.size() == spec_.operators[index].value.size());
  const GroupId group = layout_->operator_group(index);
  GroupWriter writer(group_memory(group), layout_->place(group).payload_bytes);  // takes up where the last one stopped
  std::copy(value.begin(), value.end(), writer.staging());
  writer.publish(now, 1);
}

TaskId TaskSet::find(std::string_view name) const noexcept {
  for (const Task& task : tasks_)
    if (task.spec->name == name) return task.id;
  return TaskId{};
}

VariableView TaskSet::view(std::size_t index) const noexcept {
  const Source& source = bindings_.source(VariableId(index));
  const bool is_operators = !source.task.is_valid();
  const GroupReader reader = is_operators ? operators_[source.operator_index] : source.here;
  const chimera_slot* slot = reader.published();
  if (slot == nullptr) return {};
  VariableView view;
  view.slot = slot;
  view.value = reinterpret_cast<const std::byte*>(slot + 1) + source.offset;
  view.is_valid = ((slot->valid >> source.bit) & 1u) != 0;
  if (is_operators) {
    const GivenSpec& given = spec_.operators[source.operator_index];
    view.count = given.extent[0].max * given.extent[1].max;
    return view;
  }
  const TaskMemory& producer = memories_[source.task.index];
  view.spec = producer.output_spec(source.bit);
  const chimera_port* port = producer.output_port(source.bit);
  view.count = port == nullptr ? view.spec->max_count() : port->count;
  return view;
}

std::vector<VariableReader> TaskSet::readers_of(std::size_t index) const {
  std::vector<VariableReader> readers;
  const auto add = [&](GroupId group, std::uint32_t offset, std::uint32_t bit) {
    readers.push_back({GroupReader(group_memory(group).data(), layout_->place(group).payload_bytes), offset, bit});
  };
  const Variable& variable = variables_->all()[index];
  if (variable.operator_index != UINT32_MAX) add(layout_->operator_group(variable.operator_index), 0, 0);
  for (const PortOf& producer : variable.producers)
    for (std::uint32_t half = 0; half < 2; ++half)
      add(layout_->outputs(producer.task, half), memories_[producer.task.index].output_offset(producer.index),
          producer.index);
  return readers;
}

void TaskSet::follow_others() noexcept {
  bindings_.follow_others();
  on_set_changed();
}

bool TaskSet::ring(TaskId id) noexcept {
  Task& task = tasks_[id.index];
  const bool counts = task.spec->server && task.state == State::kOn && task.events < UINT32_MAX;
  if (counts) ++task.events;
  if (task.spec->server) ++(counts ? task.profile.events : task.profile.events_lost);
  return counts;
}

void TaskSet::deliver(Task& task) noexcept {
  for (const SentSignal& sent : task.outbox) {
    Task& target = tasks_[sent.target.index];
    if (sent.signal == Signal::kWakeup && is_mine(sent.target)) {
      (void)ring(sent.target);
      continue;
    }
    const bool is_asked_of_manager = sent.signal == Signal::kOn;
    if (place_.others != nullptr && (!is_mine(sent.target) || is_asked_of_manager)) {
      const bool is_sent = place_.others->post(sent.signal, sent.target, task.id, false);
      if (!is_sent && sent.signal == Signal::kWakeup) ++task.profile.events_lost;
      continue;
    }
    defer(target, sent.signal);
  }
  task.outbox.clear();
}

void TaskSet::defer(Task& task, Signal signal) noexcept {
  if (task.pending.try_push(signal)) ++n_pending_;
  else if (signal == Signal::kKill) task.pending[task.pending.size() - 1] = Signal::kKill;
}

bool TaskSet::take_pending(Task& task, Signal& signal) noexcept {
  if (task.pending.empty()) return false;
  signal = task.pending[0];
  for (std::size_t i = 1; i < task.pending.size(); ++i) task.pending[i - 1] = task.pending[i];
  task.pending.pop_back();
  --n_pending_;
  return true;
}

// What tasks raised that are no longer ON, or all did.
void TaskSet::lower_flags(bool of_all) noexcept {
  raised_by_ = TaskId();
  for (const Task& task : tasks_) {
    raises_[task.id.index] = raises_[task.id.index] && task.state == State::kOn && !of_all;
    if (raises_[task.id.index]) raised_by_ = task.id;
  }
}

void TaskSet::on_set_changed() noexcept {
  for (const Task& task : tasks_)
    on_[task.id.index] = (is_mine(task.id) ? task.state : place_.others->state(task.id)) == State::kOn;
  on_set_legal_ = variables_->is_legal(on_);
  if (raised_by_.is_valid()) lower_flags(false);
  judge_flag();
  if (place_.others != nullptr) place_.others->changed();
}

std::int32_t TaskSet::host_expired(void* context) {
  const auto* host = static_cast<HostContext*>(context);
  JobClock& clock = host->clock != nullptr ? *host->clock : *host->set->clock_;
  if (host->task->give_up.load(std::memory_order_relaxed)) return 1;
  return clock.now().count > host->task->call.deadline_ns ? 1 : 0;
}

std::int32_t TaskSet::host_signal(void* context, std::uint32_t signal, const char* name) {
  const auto* host = static_cast<HostContext*>(context);
  const TaskId target = name == nullptr ? host->task->id : host->set->find(name);
  if (!target.is_valid() || signal > CHIMERA_SIGNAL_WAKEUP) return CHIMERA_FAULT;
  // Only a task behind a server has a doorbell: others are woken by time.
  if (signal == CHIMERA_SIGNAL_WAKEUP && !host->set->spec_.tasks[target.index].server) return CHIMERA_FAULT;
  host->task->has_news = true;
  return host->task->outbox.try_push({static_cast<Signal>(signal), target}) ? CHIMERA_OK : CHIMERA_FAULT;
}

void TaskSet::host_spend(void* context, std::int64_t ns) {
  const auto* host = static_cast<HostContext*>(context);
  (host->clock != nullptr ? *host->clock : *host->set->clock_).spend(Nanoseconds{ns});
}

// The executor sees it as it sees a fault: nobody else is told by a job.
void TaskSet::host_note(void* context, const char* text) {
  Task& task = *static_cast<HostContext*>(context)->task;
  FaultRecord& record = task.faults;
  task.has_news = true;
  std::strncpy(record.note, text, sizeof record.note - 1);
  ++record.notes;
  ++record.told;
}

const PortSpec* TaskSet::joined(void* context, const chimera_port* port) noexcept {
  const auto* host = static_cast<HostContext*>(context);
  return host->set->memories_[host->task->id.index].spec_of(port);
}

chimera_text TaskSet::host_variable(void* context, const chimera_port* port) {
  const PortSpec* spec = joined(context, port);
  if (spec == nullptr) return {"", 0};
  return {spec->variable.data(), static_cast<std::uint32_t>(spec->variable.size())};
}

chimera_text TaskSet::host_unit(void* context, const chimera_port* port) {
  const PortSpec* spec = joined(context, port);
  if (spec == nullptr) return {"", 0};
  return {spec->unit.data(), static_cast<std::uint32_t>(spec->unit.size())};
}

}  // namespace chimera
