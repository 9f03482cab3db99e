// SPDX-License-Identifier: Apache-2.0
// Compares the resources of tasks, and follows constants to those who need them.
#include "chimera/runtime/plan/rivals.h"

#include <algorithm>

#include "chimera/runtime/plan/constant_choice.h"

namespace chimera {
namespace {

bool has_task(std::span<const TaskId> tasks, TaskId task) noexcept {
  return std::find(tasks.begin(), tasks.end(), task) != tasks.end();
}

bool is_exclusive(const PortSpec& port) noexcept {
  return port.kind == CHIMERA_RESOURCE && !port.shared && !port.value.empty();
}

std::string_view text_of(const PortSpec& port) noexcept {
  return {reinterpret_cast<const char*>(port.value.data()), port.value.size()};
}

// "": none.
std::string_view common_resource(const TaskSpec& a, const TaskSpec& b) noexcept {
  for (const PortSpec& one : a.ports)
    for (const PortSpec& other : b.ports)
      if (is_exclusive(one) && is_exclusive(other) && text_of(one) == text_of(other)) return text_of(one);
  return {};
}

bool run_together(const ApplicationSpec& spec, TaskId a, TaskId b) noexcept {
  const auto names_both = [&](std::span<const TaskId> tasks) { return has_task(tasks, a) && has_task(tasks, b); };
  return names_both(spec.start) ||
         std::any_of(spec.sets.begin(), spec.sets.end(), [&](const NamedSet& set) { return names_both(set.order); });
}

template <class Act>
void for_each_pair(const ApplicationSpec& spec, Act act) {
  for (std::size_t a = 0; a < spec.tasks.size(); ++a) {
    if (!spec.tasks[a].is_hardware) continue;
    for (std::size_t b = a + 1; b < spec.tasks.size(); ++b) {
      if (!spec.tasks[b].is_hardware) continue;
      const std::string_view text = common_resource(spec.tasks[a], spec.tasks[b]);
      if (!text.empty() && !run_together(spec, TaskId(a), TaskId(b))) act(TaskId(a), TaskId(b), text);
    }
  }
}

}  // namespace

void Rivals::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  if constexpr (!mechanisms::kRivals) return;
  std::size_t n = 0;
  for_each_pair(spec, [&](TaskId, TaskId, std::string_view) { ++n; });
  if (n == 0) return;
  pairs_ = memory.take<Pair>(n);
  may_be_absent_ = memory.take<bool>(spec.tasks.size());
  is_created_at_start_ = memory.take<bool>(spec.tasks.size());
  n = 0;
  for_each_pair(spec, [&](TaskId a, TaskId b, std::string_view text) { pairs_[n++] = {a, b, text}; });
  find_absent(spec);
  find_created(spec);
}

bool Rivals::are(TaskId a, TaskId b) const noexcept { return !resource(a, b).empty(); }

std::string_view Rivals::resource(TaskId a, TaskId b) const noexcept {
  for (const Pair& pair : pairs_)
    if ((pair.a == a && pair.b == b) || (pair.a == b && pair.b == a)) return pair.text;
  return {};
}

// Producers stand before their users in the order of initialisation.
void Rivals::find_absent(const ApplicationSpec& spec) noexcept {
  for (const Pair& pair : pairs_) may_be_absent_[pair.a.index] = may_be_absent_[pair.b.index] = true;
  for (const TaskId task : spec.init_order)
    for (std::size_t c = 0; c < spec.constants.size(); ++c)
      for (const PortOf& made : spec.constants[c].producers)
        if (made.task != task && may_be_absent_[made.task.index] && spec.uses(task, ConstantId(c)))
          may_be_absent_[task.index] = true;
}

void Rivals::find_created(const ApplicationSpec& spec) noexcept {
  const std::uint32_t start = set_of_start(spec);
  for (const TaskId task : spec.start) is_created_at_start_[task.index] = true;
  for (const TaskId task : spec.init_order) {
    bool is_created = true;
    for (const Pair& pair : pairs_) {
      const TaskId rival = pair.a == task ? pair.b : pair.b == task ? pair.a : TaskId();
      if (rival.is_valid() && is_created_at_start_[rival.index]) is_created = false;
    }
    for (std::size_t c = 0; c < spec.constants.size() && is_created; ++c) {
      const std::span<const PortOf> producers = spec.constants[c].producers;
      if (producers.empty() || !spec.uses(task, ConstantId(c))) continue;
      const TaskId maker = producers[producer_for(spec, ConstantId(c), task, start)].task;
      is_created = maker == task || is_created_at_start_[maker.index];
    }
    if (is_created) is_created_at_start_[task.index] = true;
  }
}

}  // namespace chimera
