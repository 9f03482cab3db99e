// SPDX-License-Identifier: Apache-2.0
// TaskSet: constants, from those who make them to those who are initialised with them.
#include <cstdio>
#include <cstring>

#include "chimera/runtime/task_set.h"

namespace chimera {

// The entries, by dimension, of the list that the description gives for what the port is linked to: its constant, or
// its operator variable; else of the port's own value.
std::span<const std::uint32_t> TaskSet::listed(const PortSpec& port) const noexcept {
  if (!port.value.empty()) return port.listed;
  if (port.constant.is_valid()) return spec_.constants[port.constant.index].listed;
  if (!port.variable.is_valid()) return port.listed;
  const std::uint32_t given = spec_.variables[port.variable.index].operator_index;
  return given == UINT32_MAX ? port.listed : spec_.operators[given].listed;
}

// A value written as a list has as many entries as the constant says that fixes the extent.
bool TaskSet::lists_fit(const Task& task, FixedString<160>& why) const noexcept {
  for (const PortSpec& port : task.spec->ports) {
    const std::span<const std::uint32_t> entries = listed(port);
    for (std::size_t d = 0; d < CHIMERA_MAX_EXTENTS; ++d) {
      const ExtentSpec& extent = port.extent[d];
      if (!extent.constant.is_valid() || entries[d] == 0) continue;
      const std::int64_t n = constants_.integer(extent.constant, entries[d]);
      if (n == entries[d]) continue;
      const std::string_view link = spec_.link_name(port), constant = spec_.constants[extent.constant.index].name;
      char text[160];
      std::snprintf(text, sizeof text, "%.*s has a list of %u values, but %.*s is %lld", static_cast<int>(link.size()),
                    link.data(), entries[d], static_cast<int>(constant.size()), constant.data(),
                    static_cast<long long>(n));
      why.assign(text);
      return false;
    }
  }
  return true;
}

// Exactly the users of the constants that changed, in the order of initialisation; a circle is refused by
// verification, so this ends. Users in other contexts are sent the signal and compare for themselves.
void TaskSet::reinit_users(TaskId of, Nanoseconds now) {
  for (TaskId id : spec_.init_order) {
    if (id == of) continue;
    if (!is_mine(id)) {
      const State there = place_.others->state(id);
      if ((there == State::kOff || there == State::kOn) && spec_.uses_constant_of(id, of))
        (void)place_.others->post(Signal::kReinit, id, of, true);
      continue;
    }
    Task& user = tasks_[id.index];
    const bool waits = user.in_service || user.is_busy;
    if (waits && spec_.uses_constant_of(id, of)) sent_.defer(user, Signal::kReinit);
    if (waits || (user.state != State::kOff && user.state != State::kOn)) continue;
    if (memories_[id.index].uses_changed(constants_)) life_.reinit(id, now);
  }
}

void TaskSet::read_foreign_constants() noexcept {
  for (const ForeignConstant& constant : foreign_constants_) {
    const GroupReader reader = place_.others->constants(constant.producer);
    chimera_slot slot;
    if (!reader.is_bound() || !reader.try_read(slot, constant_scratch_.data()) || slot.sequence == 0) continue;
    constants_.set(constant.id, {constant_scratch_.data() + constant.offset, constant.bytes});
  }
}

bool TaskSet::uses_changed_constants(TaskId task) noexcept {
  read_foreign_constants();
  return memories_[task.index].uses_changed(constants_);
}

void TaskSet::publish_constants(const Task& task) noexcept {
  const GroupId group = layout_->constants(task.id);
  const GroupPlace& place = layout_->place(group);
  if (place.payload_bytes == 0) return;
  GroupWriter writer(group_memory(group), place.payload_bytes);
  const auto places = layout_->variables(group);
  std::size_t i = 0;
  for (const PortSpec& port : task.spec->ports) {
    if (port.kind != CHIMERA_OUT_CONST) continue;
    std::memcpy(writer.staging() + places[i].offset, constants_[port.constant].value.data(), places[i].bytes);
    ++i;
  }
  writer.publish(Nanoseconds{}, ~std::uint64_t{0});
}

}  // namespace chimera
