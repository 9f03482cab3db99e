// SPDX-License-Identifier: Apache-2.0
// Finds the present producer of each variable and points the inputs of tasks at it, directly or by a local copy.
#include "chimera/runtime/state/sources.h"

#include <algorithm>
#include <cstring>

#include "chimera/table/never_written.h"

namespace chimera {
namespace {

// A standby cycles beside its primary, unread, if it is hot.
PortOf first_producer(const ApplicationSpec& spec, const Variable& variable) noexcept {
  if constexpr (!mechanisms::kStandbys) return variable.producers[0];
  const auto is_standby = [&](const PortOf& port) {
    return std::any_of(spec.standbys.begin(), spec.standbys.end(),
                       [&](const StandbySpec& each) { return each.standby == port.task; });
  };
  const auto found = std::find_if_not(variable.producers.begin(), variable.producers.end(), is_standby);
  return found == variable.producers.end() ? variable.producers[0] : *found;
}

void fill_output(const PortSpec& port, std::span<std::byte> to) noexcept {
  if (!port.value.empty()) {
    std::memcpy(to.data(), port.value.data(), std::min(port.value.size(), to.size()));
    return;
  }
  // The fields of a struct are known where it is made; here its bytes are zero and not valid.
  fill_never_written(to, port.type == CHIMERA_FLOAT64   ? NeverWritten::kFloat64
                         : port.type == CHIMERA_FLOAT32 ? NeverWritten::kFloat32
                                                        : NeverWritten::kZero);
}

}  // namespace

void SourceCopies::prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<Task> tasks,
                           std::span<TaskMemory> memories, const PeerView* others, bool preemptive,
                           SetupMemory& memory) {
  spec_ = &spec;
  table_ = &table;
  tasks_ = tasks;
  memories_ = memories;
  others_ = others;
  preemptive_ = preemptive;
  if constexpr (!mechanisms::kCopies) return;
  std::size_t most = 0;  // a task that reads two variables of one group is counted twice
  for (const Variable& variable : spec.variables) {
    const auto is_copied = [this](const PortOf& producer) { return preemptive_ || !is_mine(producer.task); };
    auto n = std::count_if(variable.producers.begin(), variable.producers.end(), is_copied);
    if (variable.is_given()) ++n;
    for (const PortOf& consumer : variable.consumers)
      if (is_mine(consumer.task)) most += static_cast<std::size_t>(n);
  }
  copies_ = memory.take<Copy>(most).first(0);
  for (const Variable& variable : spec.variables) plan(variable, memory);
  used_ = memory.take<std::span<LocalGroup*>>(tasks.size());
  for (const Task& task : tasks) {
    const auto is_its = [&task](const Copy& copy) { return copy.consumer == task.id; };
    const auto n = std::count_if(copies_.begin(), copies_.end(), is_its);
    used_[task.id.index] = memory.take<LocalGroup*>(static_cast<std::size_t>(n));
  }
}

std::uint32_t SourceCopies::payload_of(const Source& source) const noexcept {
  const GroupId group = source.task.is_valid() ? table_->everything().outputs(source.task, 0)
                                               : table_->everything().operator_group(source.operator_index);
  return table_->everything().place(group).payload_bytes;
}

GroupReader SourceCopies::reader_of(const Source& source) const noexcept {
  if (source.here.is_bound()) return source.here;
  const bool is_operators = mechanisms::kOperators && !source.task.is_valid();
  if (is_operators && !table_->operators().empty()) return table_->operators()[source.operator_index];
  if (!mechanisms::kPeers || others_ == nullptr) return {};
  return source.task.is_valid() ? others_->outputs(source.task) : others_->operator_variable(source.operator_index);
}

Source SourceCopies::source_from(const PortOf& producer) const noexcept {
  Source source{producer.task, 0, 0, producer.index, {}};
  if (is_mine(producer.task)) {
    source.offset = memories_[producer.task.index].output_offset(producer.index);
    source.here = memories_[producer.task.index].reader();
  } else {
    const PeerLayout& layout = table_->everything();
    source.offset = layout.variables(layout.outputs(producer.task, 0))[producer.index].offset;
  }
  return source;
}

void SourceCopies::plan(const Variable& variable, SetupMemory& memory) {
  for (const PortOf& consumer : variable.consumers) {
    if (!is_mine(consumer.task)) continue;
    if (variable.is_given()) plan(consumer.task, operator_source(variable), memory);
    for (const PortOf& producer : variable.producers)
      if (preemptive_ || !is_mine(producer.task)) plan(consumer.task, source_from(producer), memory);
  }
}

// Requires: there is room behind copies_.
void SourceCopies::plan(TaskId consumer, const Source& source, SetupMemory& memory) {
  if (find(consumer, source) != nullptr) return;
  const std::uint32_t payload = payload_of(source);
  const std::span<std::byte> bytes = memory.take_bytes(local_group_bytes(payload), kCacheLine);
  copies_ = {copies_.data(), copies_.size() + 1};
  copies_.back() = {LocalGroup(GroupReader(nullptr, payload), bytes), consumer, source, false, false};
  for (std::uint32_t half = 0; half < 2; ++half) fill(source, copies_.back().group.values_of_half(half));
}

// Fills a copy with the values that it has before its producer was ever seen.
void SourceCopies::fill(const Source& source, std::span<std::byte> values) const noexcept {
  if (!source.task.is_valid()) return;
  const auto places = table_->everything().variables(table_->everything().outputs(source.task, 0));
  std::size_t i = 0;
  for (const PortSpec& port : tasks_[source.task.index].spec->ports)
    if (port.kind == CHIMERA_OUT_VAR) {
      fill_output(port, values.subspan(places[i].offset, port.max_bytes()));
      ++i;
    }
}

SourceCopies::Copy* SourceCopies::find(TaskId consumer, const Source& source) noexcept {
  for (Copy& copy : copies_)
    if (copy.consumer == consumer && is_same_group(copy.of, source)) return &copy;
  return nullptr;
}

bool SourceCopies::has(TaskId consumer, TaskId producer) const noexcept {
  return std::any_of(copies_.begin(), copies_.end(),
                     [&](const Copy& copy) { return copy.consumer == consumer && copy.of.task == producer; });
}

void SourceCopies::follow(TaskId consumer) noexcept {
  for (Copy& copy : copies_)
    if (copy.consumer == consumer) bind(copy, false);
}

void SourceCopies::follow_now(TaskId consumer, const Source& source) noexcept {
  if (Copy* copy = find(consumer, source)) bind(*copy, true);
}

void SourceCopies::bind(Copy& copy, bool is_new) noexcept {
  const TaskId of = copy.of.task;
  const bool is_here = of.is_valid() && is_mine(of);
  const bool was_read = of.is_valid() && copy.was_bound && !is_new;
  if (was_read && (is_here ? tasks_[of.index].shown_state() : others_->state(of)) != State::kOn) return;
  const GroupReader reader = is_here ? memories_[of.index].reader() : reader_of(copy.of);
  if (!reader.is_bound()) return;
  copy.group.rebind(reader);
  copy.is_bound = copy.was_bound = true;
}

void SourceCopies::let_go(TaskId producer) noexcept {
  for (Copy& copy : copies_)
    if (copy.of.task == producer) copy.is_bound = false;
}

void SourceCopies::forget(TaskId producer) noexcept {
  for (Copy& copy : copies_)
    if (copy.of.task == producer) copy.is_bound = copy.was_bound = false;
}

void SourceCopies::list(TaskId consumer) noexcept {
  const std::span<LocalGroup*> used = used_[consumer.index];
  Task& task = tasks_[consumer.index];
  std::size_t n = 0;
  for (Copy& copy : copies_) {
    if (copy.consumer != consumer || !copy.is_bound) continue;
    const auto reads = [&copy](const Input& input) { return input.group.follows(copy.group); };
    if (std::any_of(task.inputs.begin(), task.inputs.end(), reads)) used[n++] = &copy.group;
  }
  task.copies = used.first(n);
}

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
  if constexpr (mechanisms::kCopies) {
    std::uint32_t largest = 0;
    for (const GroupPlace& group : table.everything().table().groups())
      largest = std::max(largest, group.payload_bytes);
    scratch_ = memory.take_bytes(sizeof(chimera_slot) + largest, kCacheLine);
  }
  for (std::size_t v = 0; v < sources_.size(); ++v) {
    const Variable& variable = spec.variables[v];
    if (variable.is_given()) bind(VariableId(v), operator_source(variable));
    else if (!variable.producers.empty()) bind(VariableId(v), copies_.source_from(first_producer(spec, variable)));
  }
  everybody_follows();
}

// A job that is under way, or was released before the instant of a change.
bool Sources::keeps(TaskId consumer) const noexcept {
  return (mechanisms::kPreemptive && preemptive_ && tasks_[consumer.index].is_busy) ||
         (mechanisms::kSwitch && has_old_job_[consumer.index]);
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
  const bool is_direct = !mechanisms::kCopies || (source.here.is_bound() && !preemptive_);
  input.group = is_direct ? GroupInput::direct(copies_.reader_of(source))
                          : GroupInput::following(copies_.of(consumer, source));
  input.offset = source.offset;
  input.bit = source.bit;
  input.sequence = 0;
}

void Sources::take_outputs_of(const Task& task) noexcept {
  for (std::uint32_t i = 0; i < task.outputs.size(); ++i)
    bind(task.outputs[i].spec->variable, copies_.source_from({task.id, i}));
  if constexpr (mechanisms::kCopies) copies_.forget(task.id);  // that was its last incarnation
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
    if constexpr (mechanisms::kCopies) copies_.follow_now(consumer, source);
  }
  if constexpr (mechanisms::kCopies) copies_.list(consumer);
}

void Sources::hand_over(std::span<const bool> has_old_job) noexcept {
  std::copy(has_old_job.begin(), has_old_job.end(), has_old_job_.begin());
  for (const Handover& handover : handed_over_) {
    bind(handover.variable, copies_.source_from(handover.to));
    if constexpr (mechanisms::kCopies) copies_.forget(handover.to.task);
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
  if (!mechanisms::kPeers || others_ == nullptr) return;
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
  if constexpr (!mechanisms::kCopies) return;
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
  if constexpr (!mechanisms::kCopies && !mechanisms::kSwitch) return;
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
  if (!mechanisms::kCopies || (source.here.is_bound() && !preemptive_)) return reader.published();
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
