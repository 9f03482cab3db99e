// SPDX-License-Identifier: Apache-2.0
// TaskSet: constants, from those who make them to those who are initialised with them.
#include <cstdio>
#include <cstring>

#include "chimera/runtime/task_set.h"

namespace chimera {

const GivenSpec* TaskSet::given(std::string_view variable) const noexcept {
  for (const auto& list : {spec_.constants, spec_.operators})
    for (const GivenSpec& given : list)
      if (given.name == variable) return &given;
  return nullptr;
}

// A value written as a list has as many entries as the constant says that fixes the extent.
bool TaskSet::lists_fit(const Task& task, FixedString<160>& why) const noexcept {
  for (const PortSpec& port : task.spec->ports) {
    const GivenSpec* from = port.value.empty() && !port.variable.empty() ? given(port.variable) : nullptr;
    const std::uint32_t* listed = from != nullptr ? from->listed : port.listed;
    for (std::size_t d = 0; d < CHIMERA_MAX_EXTENTS; ++d) {
      const ExtentSpec& extent = port.extent[d];
      if (extent.constant.empty() || listed[d] == 0) continue;
      const std::int64_t n = constants_.integer(extent.constant, listed[d]);
      if (n == listed[d]) continue;
      char text[160];
      std::snprintf(text, sizeof text, "%.*s has a list of %u values, but %.*s is %lld",
                    static_cast<int>(port.variable.size()), port.variable.data(), listed[d],
                    static_cast<int>(extent.constant.size()), extent.constant.data(), static_cast<long long>(n));
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
      if ((there == State::kOff || there == State::kOn) && uses_constant_of(id, of))
        (void)place_.others->post(Signal::kReinit, id, of, true);
      continue;
    }
    Task& user = tasks_[id.index];
    const bool waits = user.in_service || user.is_busy;
    if (waits && uses_constant_of(id, of)) sent_.defer(user, Signal::kReinit);
    if (waits || (user.state != State::kOff && user.state != State::kOn)) continue;
    if (memories_[id.index].uses_changed(constants_)) life_.reinit(id, now);
  }
}

bool TaskSet::uses_constant_of(TaskId user, TaskId producer) const noexcept {
  for (const PortSpec& made : spec_.tasks[producer.index].ports)
    for (const PortSpec& used : spec_.tasks[user.index].ports)
      if (made.kind == CHIMERA_OUT_CONST && used.kind == CHIMERA_IN_CONST && made.variable == used.variable)
        return true;
  return false;
}

void TaskSet::read_foreign_constants() noexcept {
  for (const ForeignConstant& constant : foreign_constants_) {
    const GroupReader reader = place_.others->constants(constant.producer);
    chimera_slot slot;
    if (!reader.is_bound() || !reader.try_read(slot, constant_scratch_.data()) || slot.sequence == 0) continue;
    constants_.set(constant.name, {constant_scratch_.data() + constant.offset, constant.bytes}, constant.producer);
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
    const Constant* constant = constants_.find(port.variable);
    std::memcpy(writer.staging() + places[i].offset, constant->value.data(), places[i].bytes);
    ++i;
  }
  writer.publish(Nanoseconds{}, ~std::uint64_t{0});
}

}  // namespace chimera
