// SPDX-License-Identifier: Apache-2.0
// Makes the tasks of a context from their specs and wires them.
#include "chimera/runtime/task_set.h"

#include <algorithm>
#include <cstring>

namespace chimera {

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
    (void)methods_.end_background(tasks_[t], {});
    methods_.destroy(tasks_[t]);
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
  hosts_.resize(n);
  on_.assign(n, false);
  listed_.resize(n);
  methods_.prepare(memories_, {place_.at_edge, place_.making});
  slow_.prepare(tasks_, hosts_, methods_, place_.service, *place_.serving);
  sent_.prepare(tasks_, memories_, place_.others);
  flag_.prepare(*variables_, tasks_);
  life_.prepare(n);
  if (!is_alone()) changes_.prepare(n);
  for (std::size_t t = 0; t < n; ++t) prepare_task(t);
  for (std::size_t t = 0; t < n; ++t) tasks_[t].component = components[t];
  for (const Variable& variable : variables_->all()) {
    if (!variable.producers.empty() || variable.operator_index != UINT32_MAX) continue;
    const std::string_view reader = spec_.tasks[variable.consumers[0].task.index].name;
    return Error{ErrorCode::kBadInput, {"nobody produces state variable " + std::string(variable.name)}, {reader}};
  }
  if (auto laid = lay_out(); !laid) return laid;
  constants_ = ConstantStore(spec_);
  plan_foreign_constants();
  place_operators();
  sources_.prepare(*variables_, *everything_, tasks_, memories_, operators_, place_.others,
                    place_.preemptive);
  return {};
}

void TaskSet::prepare_task(std::size_t t) {
  Task& task = tasks_[t];
  task.spec = &spec_.tasks[t];
  task.id = TaskId(t);
  hosts_[t] = {this, &task, nullptr};
  task.call.fault = &task.said;
  task.call.host = &TaskHost::kCalls;
  task.call.context = &hosts_[t];
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
          {TaskId(t), port.constant, everything_->variables(group)[i].offset, port.max_bytes()});
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
  const Source& source = sources_.source(VariableId(index));
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
  sources_.follow_others();
  on_set_changed();
}

void TaskSet::raise_flag_for(TaskId task) noexcept {
  flag_.raise_for(task);
  on_set_changed();
}

void TaskSet::on_set_changed() noexcept {
  for (const Task& task : tasks_)
    on_[task.id.index] = (is_mine(task.id) ? task.state : place_.others->state(task.id)) == State::kOn;
  flag_.follow(on_);
  for (const Task& task : tasks_) {
    if (!is_mine(task.id)) continue;
    const TaskStatus now{task.state, task.in_service, memories_[task.id.index].incarnation()};
    TaskStatus& listed = listed_[task.id.index];
    if (now != listed) changes_.add_status(task.id, listed, now);
    listed = now;
  }
  changes_.add_flag();
}

}  // namespace chimera
