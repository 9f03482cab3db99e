// SPDX-License-Identifier: Apache-2.0
// Plans the table of a context and finds the groups in it.
#include "chimera/runtime/state/context_table.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/base/mechanisms.h"

namespace chimera {

Result<void> ContextTable::prepare(const ApplicationSpec& spec, const ContextPlace& place, SetupMemory& memory) {
  if constexpr (!mechanisms::kCopies) return prepare_alone(spec, memory), Result<void>{};
  const auto everything = PeerLayout::of_everything(spec, memory);
  if (!everything) return everything.error();
  everything_ = own_ = *everything;
  if (place.rtpu.is_valid()) {
    const auto own = PeerLayout::of(spec, place.rtpu.index, memory);
    if (!own) return own.error();
    own_ = *own;
  }
  const std::size_t bytes = own_.table().region_bytes();
  table_ = place.table.empty() ? memory.take_bytes(bytes, kCacheLine) : place.table;
  CHIMERA_ASSERT(table_.size() >= bytes);
  if (place.rtpu.is_valid()) return {};  // operator variables are the manager's
  operators_ = memory.take<GroupReader>(spec.operators.size());
  for (std::size_t o = 0; o < operators_.size(); ++o) {
    operators_[o] = reader(own_.operator_group(o));
    set_operator(o, spec.operators[o].value, Nanoseconds{});
  }
  return {};
}

void ContextTable::prepare_alone(const ApplicationSpec& spec, SetupMemory& memory) {
  if constexpr (!mechanisms::kOperators) return;
  operators_ = memory.take<GroupReader>(spec.operators.size());
  own_operators_ = memory.take<std::span<std::byte>>(spec.operators.size());
  for (std::size_t o = 0; o < operators_.size(); ++o) {
    const GivenSpec& given = spec.operators[o];
    const std::uint32_t payload = round_to_value(given.element_bytes * given.extent[0].max * given.extent[1].max);
    own_operators_[o] = memory.take_bytes(group_bytes(payload), kCacheLine);
    operators_[o] = GroupReader(own_operators_[o].data(), payload);
    set_operator(o, given.value, Nanoseconds{});
  }
}

void ContextTable::place_outputs(TaskId task, TaskMemory& its, SetupMemory& memory) const {
  const std::uint32_t payload = its.reader().payload_bytes();
  if constexpr (mechanisms::kCopies) {
    const GroupId first = own_.outputs(task, 0), second = own_.outputs(task, 1);
    CHIMERA_ASSERT(own_.place(first).payload_bytes == payload);
    its.place(group(first), group(second));
  } else {
    const std::span<std::byte> first = memory.take_bytes(group_bytes(payload), kCacheLine);
    its.place(first, memory.take_bytes(group_bytes(payload), kCacheLine));
  }
}

std::span<std::byte> ContextTable::group(GroupId group) const noexcept {
  const GroupPlace& place = own_.place(group);
  return table_.subspan(place.offset, group_bytes(place.payload_bytes));
}

void ContextTable::set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now,
                                bool valid) noexcept {
  CHIMERA_ASSERT(index < operators_.size() && value.size() <= operators_[index].payload_bytes());
  const std::span<std::byte> bytes =
      mechanisms::kCopies ? group(own_.operator_group(index)) : own_operators_[index];
  GroupWriter to(bytes, operators_[index].payload_bytes());  // takes up where the last one stopped
  std::copy(value.begin(), value.end(), to.staging());
  to.publish(now, valid ? 1 : 0);
}

VariableReader ContextTable::reader_of(const PortOf& producer, std::uint32_t half) const noexcept {
  const GroupId id = own_.outputs(producer.task, half);
  return {reader(id), own_.variables(id)[producer.index].offset, producer.index};
}

}  // namespace chimera
