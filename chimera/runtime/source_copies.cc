// SPDX-License-Identifier: Apache-2.0
// Plans the copies of groups that are produced elsewhere, and points them at the groups of the present producers.
#include "chimera/runtime/source_copies.h"

#include <algorithm>
#include <cstring>

#include "chimera/table/never_written.h"

namespace chimera {
namespace {

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
  std::size_t most = 0;  // a task that reads two variables of one group is counted twice
  for (const Variable& variable : spec.variables) {
    const auto is_copied = [this](const PortOf& producer) { return preemptive_ || !is_mine(producer.task); };
    auto n = std::count_if(variable.producers.begin(), variable.producers.end(), is_copied);
    if (variable.operator_index != UINT32_MAX) ++n;
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
  if (!source.task.is_valid() && !table_->operators().empty()) return table_->operators()[source.operator_index];
  if (others_ == nullptr) return {};
  return source.task.is_valid() ? others_->outputs(source.task) : others_->operator_variable(source.operator_index);
}

Source SourceCopies::source_from(const PortOf& producer) const noexcept {
  const auto places = table_->everything().variables(table_->everything().outputs(producer.task, 0));
  Source source{producer.task, 0, places[producer.index].offset, producer.index, {}};
  if (is_mine(producer.task)) source.here = memories_[producer.task.index].reader();
  return source;
}

void SourceCopies::plan(const Variable& variable, SetupMemory& memory) {
  for (const PortOf& consumer : variable.consumers) {
    if (!is_mine(consumer.task)) continue;
    if (variable.operator_index != UINT32_MAX) plan(consumer.task, operator_source(variable), memory);
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

// What stands in a copy before its producer was ever seen.
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

}  // namespace chimera
