// SPDX-License-Identifier: Apache-2.0
// Moves constants between tasks, the store of their context, and other contexts.
#include "chimera/runtime/state/context_constants.h"

#include <algorithm>
#include <cstring>

#include "chimera/base/message.h"

namespace chimera {

void ContextConstants::prepare(const ApplicationSpec& spec, const ContextTable& table, std::span<TaskMemory> memories,
                               const PeerView* others, SetupMemory& memory) {
  spec_ = &spec;
  table_ = &table;
  memories_ = memories;
  others_ = others;
  store_ = ConstantStore(spec, memory);
  for (const ConstantSpec& constant : spec.constants) has_choice_ = has_choice_ || constant.producers.size() > 1;
  if constexpr (mechanisms::kSwitch) in_force_ = set_of_start(spec);
  if constexpr (mechanisms::kPeers) plan_foreign(memory);
}

// The producers that count for the task do so until the next task is looked at.
void ContextConstants::choose_for(TaskId task) noexcept {
  if (!has_choice()) return;
  for (std::size_t c = 0; c < spec_->constants.size(); ++c)
    store_.choose(ConstantId(c), producer_for(*spec_, ConstantId(c), task, in_force_));
}

bool ContextConstants::uses_changed(TaskId task) noexcept {
  choose_for(task);
  return memories_[task.index].uses_changed(store_);
}

bool ContextConstants::would_take(TaskId task, FaultWords& why) noexcept {
  choose_for(task);
  return memories_[task.index].would_take(store_, why) && lists_fit(task, why);
}

bool ContextConstants::differ(ConstantId constant, std::uint32_t a, std::uint32_t b) const noexcept {
  const Constant &one = store_.of(constant, a), &other = store_.of(constant, b);
  if (!one.is_known || !other.is_known) return true;
  return std::memcmp(one.value.data(), other.value.data(), one.value.size()) != 0;
}

void ContextConstants::plan_foreign(SetupMemory& memory) {
  std::uint32_t largest = 0;
  std::size_t n = 0;
  const PeerLayout& layout = table_->everything();
  const auto of_task = [&layout](std::size_t t) { return layout.variables(layout.constants(TaskId(t))); };
  for (std::size_t t = 0; t < memories_.size(); ++t) {
    if (memories_[t].is_planned()) continue;
    largest = std::max(largest, layout.place(layout.constants(TaskId(t))).payload_bytes);
    n += of_task(t).size();
  }
  scratch_ = memory.take_bytes(largest, kCacheLine);
  foreign_ = memory.take<Foreign>(n);
  n = 0;
  for (std::size_t t = 0; t < memories_.size(); ++t) {
    if (memories_[t].is_planned()) continue;
    std::size_t i = 0;
    for (const PortSpec& port : spec_->tasks[t].ports)
      if (port.kind == CHIMERA_OUT_CONST)
        foreign_[n++] = {TaskId(t), port.constant, of_task(t)[i++].offset, port.max_bytes()};
  }
}

void ContextConstants::read_foreign() noexcept {
  for (const Foreign& constant : foreign_) {
    const GroupReader reader = others_->constants(constant.producer);
    chimera_slot slot;
    if (!reader.is_bound() || !reader.try_read(slot, scratch_.data()) || slot.sequence == 0) continue;
    store_.set_by(constant.producer, constant.id, {scratch_.data() + constant.offset, constant.bytes});
  }
}

bool ContextConstants::give(TaskId task, FaultWords& why) noexcept {
  if constexpr (mechanisms::kPeers) read_foreign();
  choose_for(task);
  return memories_[task.index].read_constants(store_, why) && lists_fit(task, why);
}

bool ContextConstants::collect(TaskId task, FaultWords& why) noexcept {
  TaskMemory& memory = memories_[task.index];
  const int changed = mechanisms::kConstants ? memory.write_constants(store_, task) : 0;
  choose_for(task);
  has_new_ = false;
  if (!memory.fix_extents(store_, why) || !lists_fit(task, why)) return false;
  if (mechanisms::kPeers && others_ != nullptr) publish(task);
  has_new_ = changed > 0;
  return true;
}

void ContextConstants::publish(TaskId task) noexcept {
  const auto places = table_->constant_places(task);
  if (places.empty()) return;
  GroupWriter writer = table_->constant_writer(task);
  std::size_t i = 0;
  for (const PortSpec& port : spec_->tasks[task.index].ports) {
    if (port.kind != CHIMERA_OUT_CONST) continue;
    const auto producers = spec_->constants[port.constant.index].producers;
    const auto is_it = [task](const PortOf& each) { return each.task == task; };
    const auto found = std::find_if(producers.begin(), producers.end(), is_it);
    const auto k = static_cast<std::uint32_t>(found == producers.end() ? 0 : found - producers.begin());
    const Constant& made = store_.of(port.constant, k);
    std::memcpy(writer.staging() + places[i].offset, made.value.data(), places[i].bytes);
    ++i;
  }
  writer.publish(Nanoseconds{}, ~std::uint64_t{0});
}

// The entries, by dimension, of the list that the description gives: for the port's own value, or for the constant or
// operator variable that the port is linked to.
std::span<const std::uint32_t> ContextConstants::listed(const PortSpec& port) const noexcept {
  if (!port.value.empty()) return port.listed;
  if (port.constant.is_valid()) return spec_->constants[port.constant.index].listed;
  if (!port.variable.is_valid()) return port.listed;
  const std::uint32_t given = spec_->variables[port.variable.index].operator_index;
  return given == UINT32_MAX ? port.listed : spec_->operators[given].listed;
}

// A value written as a list has as many entries as the constant says that fixes the extent.
bool ContextConstants::lists_fit(TaskId task, FaultWords& why) const noexcept {
  if constexpr (!mechanisms::kConstants) return true;  // the description gives all constants, which are verified
  for (const PortSpec& port : spec_->tasks[task.index].ports) {
    const std::span<const std::uint32_t> entries = listed(port);
    for (std::size_t d = 0; d < CHIMERA_MAX_EXTENTS; ++d) {
      const ExtentSpec& extent = port.extent[d];
      if (!extent.constant.is_valid() || entries[d] == 0) continue;
      const std::int64_t n = store_.integer(extent.constant, entries[d]);
      if (n == entries[d]) continue;
      const std::string_view link = spec_->link_name(port), constant = spec_->constants[extent.constant.index].name;
      Message text(link);
      text << " has a list of " << entries[d] << " values, but " << constant << " is " << n;
      why.assign(text.view());
      return false;
    }
  }
  return true;
}

}  // namespace chimera
