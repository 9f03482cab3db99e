// SPDX-License-Identifier: Apache-2.0
// Plans the table of a context and finds the groups in it.
#include "chimera/runtime/context_table.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {

Result<void> ContextTable::prepare(const ApplicationSpec& spec, const ContextPlace& place) {
  auto everything = PeerLayout::of_everything(spec);
  if (!everything) return everything.error();
  everything_ = std::make_unique<PeerLayout>(*std::move(everything));
  if (place.rtpu.is_valid()) {
    auto own = PeerLayout::of(spec, place.rtpu.index);
    if (!own) return own.error();
    own_ = std::make_unique<PeerLayout>(*std::move(own));
  } else {
    own_ = std::make_unique<PeerLayout>(*everything_);
  }
  if (place.table.empty()) memory_ = AlignedBytes(own_->table().region_bytes(), kCacheLine);
  table_ = place.table.empty() ? memory_.span() : place.table;
  CHIMERA_ASSERT(table_.size() >= own_->table().region_bytes());
  if (place.rtpu.is_valid()) return {};  // operator variables are the manager's
  for (std::size_t o = 0; o < spec.operators.size(); ++o) {
    operators_.push_back(reader(own_->operator_group(o)));
    set_operator(o, spec.operators[o].value, Nanoseconds{});
  }
  return {};
}

void ContextTable::place_outputs(TaskId task, TaskMemory& memory) const noexcept {
  const GroupId first = own_->outputs(task, 0), second = own_->outputs(task, 1);
  memory.place(group(first), group(second), own_->place(first).payload_bytes, own_->variables(first));
}

std::span<std::byte> ContextTable::group(GroupId group) const noexcept {
  const GroupPlace& place = own_->place(group);
  return table_.subspan(place.offset, group_bytes(place.payload_bytes));
}

void ContextTable::set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept {
  CHIMERA_ASSERT(index < operators_.size() && value.size() <= operators_[index].payload_bytes());
  GroupWriter to = writer(own_->operator_group(index));  // takes up where the last one stopped
  std::copy(value.begin(), value.end(), to.staging());
  to.publish(now, 1);
}

std::vector<VariableReader> ContextTable::readers_of(const Variable& variable) const {
  std::vector<VariableReader> readers;
  if (variable.operator_index != UINT32_MAX) readers.push_back({operators_[variable.operator_index], 0, 0});
  for (const PortOf& producer : variable.producers) {
    for (std::uint32_t half = 0; half < 2; ++half) {
      const GroupId id = own_->outputs(producer.task, half);
      readers.push_back({reader(id), own_->variables(id)[producer.index].offset, producer.index});
    }
  }
  return readers;
}

}  // namespace chimera
