// SPDX-License-Identifier: Apache-2.0
// Finds the present producer of each variable and points the inputs of tasks at it, directly or by a local copy.
#include "chimera/runtime/sources.h"

#include <algorithm>

namespace chimera {
namespace {

// A standby cycles beside its primary, unread, if it is hot.
PortOf first_producer(const ApplicationSpec& spec, const Variable& variable) noexcept {
  const auto is_standby = [&](const PortOf& port) {
    return std::any_of(spec.standbys.begin(), spec.standbys.end(),
                       [&](const StandbySpec& each) { return each.standby == port.task; });
  };
  const auto found = std::find_if_not(variable.producers.begin(), variable.producers.end(), is_standby);
  return found == variable.producers.end() ? variable.producers[0] : *found;
}

}  // namespace

void Sources::prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<Task> tasks,
                      std::span<TaskMemory> memories, const PeerView* others, bool preemptive, SetupMemory& memory) {
  preemptive_ = preemptive;
  spec_ = &spec;
  table_ = &table;
  tasks_ = tasks;
  memories_ = memories;
  others_ = others;
  copies_.prepare(spec, table, tasks, memories, others, preemptive, memory);
  sources_ = memory.take<Source>(spec.variables.size());
  is_behind_ = memory.take<bool>(tasks.size());
  has_old_job_ = memory.take<bool>(tasks.size());
  std::uint32_t largest = 0;
  for (const GroupPlace& group : table.everything().table().groups()) largest = std::max(largest, group.payload_bytes);
  scratch_ = memory.take_bytes(sizeof(chimera_slot) + largest, kCacheLine);
  for (std::size_t v = 0; v < sources_.size(); ++v) {
    const Variable& variable = spec.variables[v];
    if (variable.operator_index != UINT32_MAX) bind(VariableId(v), operator_source(variable));
    else if (!variable.producers.empty()) bind(VariableId(v), copies_.source_from(first_producer(spec, variable)));
  }
  everybody_follows();
}

// A job that is under way, or was released before the instant of a change.
bool Sources::keeps(TaskId consumer) const noexcept {
  return (preemptive_ && tasks_[consumer.index].is_busy) || has_old_job_[consumer.index];
}

void Sources::bind(VariableId variable, const Source& source) noexcept {
  sources_[variable.index] = source;
  for (const PortOf& consumer : spec_->variables[variable.index].consumers) {
    if (!is_mine(consumer.task)) continue;
    if (keeps(consumer.task)) is_behind_[consumer.task.index] = true;
    else bind_input(tasks_[consumer.task.index].inputs[consumer.index], consumer.task, source);
  }
}

void Sources::bind_input(Input& input, TaskId consumer, const Source& source) noexcept {
  const bool is_direct = source.here.is_bound() && !preemptive_;
  input.group =
      is_direct ? GroupInput::direct(source.here) : GroupInput::following(copies_.of(consumer, source));
  input.offset = source.offset;
  input.bit = source.bit;
  input.sequence = 0;
}

void Sources::take_outputs_of(const Task& task) noexcept {
  for (std::uint32_t i = 0; i < task.outputs.size(); ++i)
    bind(task.outputs[i].spec->variable, copies_.source_from({task.id, i}));
  copies_.forget(task.id);  // that was its last incarnation
  everybody_follows();
}

void Sources::read_ahead(TaskId consumer, std::span<const Handover> handovers,
                         std::span<const TaskId> armed) noexcept {
  const auto is_armed = [armed](TaskId producer) {
    return std::find(armed.begin(), armed.end(), producer) != armed.end();
  };
  Task& task = tasks_[consumer.index];
  for (std::uint32_t i = 0; i < task.inputs.size(); ++i) {
    const VariableId variable = memories_[consumer.index].input_spec(i).variable;
    Source source = sources_[variable.index];
    for (const Handover& handover : handovers)
      if (handover.variable == variable && is_armed(handover.to.task)) source = copies_.source_from(handover.to);
    bind_input(task.inputs[i], consumer, source);
    copies_.follow_now(consumer, source);
  }
  copies_.list(consumer);
}

void Sources::hand_over(std::span<const bool> has_old_job) noexcept {
  std::copy(has_old_job.begin(), has_old_job.end(), has_old_job_.begin());
  for (const Handover& handover : handed_over_) {
    bind(handover.variable, copies_.source_from(handover.to));
    copies_.forget(handover.to.task);
  }
  everybody_follows();
}

void Sources::old_job_ended(TaskId consumer) noexcept {
  has_old_job_[consumer.index] = false;
  if (!is_behind_[consumer.index]) return;
  Task& task = tasks_[consumer.index];
  for (std::uint32_t i = 0; i < task.inputs.size(); ++i) {
    const VariableId variable = memories_[consumer.index].input_spec(i).variable;
    if (is_handed_over(variable)) bind_input(task.inputs[i], consumer, sources_[variable.index]);
  }
  follow(consumer);
}

void Sources::end_handover() noexcept {
  handed_over_ = {};
  follow_others();
}

bool Sources::is_handed_over(VariableId variable) const noexcept {
  const auto is_its = [variable](const Handover& handover) { return handover.variable == variable; };
  return std::any_of(handed_over_.begin(), handed_over_.end(), is_its);
}

void Sources::follow_others() noexcept {
  if (others_ == nullptr) return;
  for (std::size_t v = 0; v < sources_.size(); ++v) {
    if (is_handed_over(VariableId(v))) continue;
    const Variable& variable = spec_->variables[v];
    for (const PortOf& producer : variable.producers) {
      if (is_mine(producer.task) || producer.task == sources_[v].task) continue;
      if (others_->state(producer.task) == State::kOn) bind(VariableId(v), copies_.source_from(producer));
    }
  }
  everybody_follows();
}

void Sources::adopt(TaskId consumer) noexcept {
  if (has_old_job_[consumer.index]) return;
  is_behind_[consumer.index] = false;
  Task& task = tasks_[consumer.index];
  copies_.follow(consumer);
  for (std::uint32_t i = 0; preemptive_ && i < task.inputs.size(); ++i) {
    const Source& source = sources_[memories_[consumer.index].input_spec(i).variable.index];
    if (!task.inputs[i].group.follows(copies_.of(consumer, source))) bind_input(task.inputs[i], consumer, source);
  }
  copies_.list(consumer);
}

void Sources::follow(TaskId consumer) noexcept {
  if (keeps(consumer)) is_behind_[consumer.index] = true;
  else adopt(consumer);
}

void Sources::everybody_follows() noexcept {
  for (const Task& task : tasks_)
    if (is_mine(task.id)) follow(task.id);
}

void Sources::let_go(TaskId producer) noexcept {
  copies_.let_go(producer);
  for (const Task& task : tasks_) {
    if (!is_mine(task.id) || !copies_.has(task.id, producer)) continue;
    if (keeps(task.id)) is_behind_[task.id.index] = true;
    else copies_.list(task.id);
  }
}

bool Sources::is_any_behind() const noexcept {
  return std::find(is_behind_.begin(), is_behind_.end(), true) != is_behind_.end();
}

const chimera_slot* Sources::latest(VariableId variable) noexcept {
  const Source& source = sources_[variable.index];
  const GroupReader reader = copies_.reader_of(source);
  if (!reader.is_bound()) return nullptr;
  if (source.here.is_bound() && !preemptive_) return reader.published();
  auto* slot = reinterpret_cast<chimera_slot*>(scratch_.data());
  return reader.try_read(slot) ? slot : nullptr;
}

bool Sources::is_initial(VariableId variable, std::uint64_t sequence) const noexcept {
  return copies_.reader_of(sources_[variable.index]).is_initial(sequence);
}

VariableView Sources::view(VariableId variable) const noexcept {
  const Source& source = sources_[variable.index];
  const bool is_operators = !source.task.is_valid();
  const GroupReader reader = is_operators ? table_->operators()[source.operator_index] : source.here;
  const chimera_slot* slot = reader.published();
  if (slot == nullptr) return {};
  VariableView view;
  view.slot = slot;
  view.value = reinterpret_cast<const std::byte*>(slot + 1) + source.offset;
  view.is_valid = ((slot->valid >> source.bit) & 1u) != 0;
  if (is_operators) {
    const GivenSpec& given = spec_->operators[source.operator_index];
    view.count = given.extent[0].max * given.extent[1].max;
    return view;
  }
  const TaskMemory& producer = memories_[source.task.index];
  view.spec = producer.output_spec(source.bit);
  const chimera_port* port = producer.output_port(source.bit);
  view.count = port == nullptr ? view.spec->max_count() : port->count;
  return view;
}

}  // namespace chimera
