// SPDX-License-Identifier: Apache-2.0
// Chooses among the producers of a constant by configurations, and follows a choice to those who use it.
#include "chimera/runtime/plan/constant_choice.h"

#include <algorithm>

namespace chimera {
namespace {

bool names(const NamedSet& set, TaskId task) noexcept {
  return std::find(set.order.begin(), set.order.end(), task) != set.order.end();
}

// Whose constants a task has: those of the configuration in force, of the first one that names it, else the former.
std::uint32_t set_for(const ApplicationSpec& spec, TaskId user, std::uint32_t in_force) noexcept {
  if (in_force < spec.sets.size() && names(spec.sets[in_force], user)) return in_force;
  for (std::uint32_t s = 0; s < spec.sets.size(); ++s)
    if (names(spec.sets[s], user)) return s;
  return in_force;
}

bool has(std::span<const TaskId> tasks, TaskId task) noexcept {
  return std::find(tasks.begin(), tasks.end(), task) != tasks.end();
}

}  // namespace

std::uint32_t set_of_start(const ApplicationSpec& spec) noexcept {
  for (std::uint32_t s = 0; s < spec.sets.size(); ++s) {
    const std::span<const TaskId> order = spec.sets[s].order;
    const bool is_it = order.size() == spec.start.size() &&
                       std::all_of(order.begin(), order.end(), [&](TaskId task) { return has(spec.start, task); });
    if (is_it) return s;
  }
  return kNoSet;
}

std::uint32_t producer_for(const ApplicationSpec& spec, ConstantId constant, TaskId user,
                           std::uint32_t in_force) noexcept {
  const std::span<const PortOf> producers = spec.constants[constant.index].producers;
  if (producers.size() < 2) return 0;
  const std::uint32_t set = set_for(spec, user, in_force);
  for (std::uint32_t k = 0; k < producers.size(); ++k)
    if (set < spec.sets.size() && names(spec.sets[set], producers[k].task)) return k;
  return 0;
}

void ConstantUsers::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  spec_ = &spec;
  const auto has_several = [](const ConstantSpec& constant) { return constant.producers.size() > 1; };
  if (std::none_of(spec.constants.begin(), spec.constants.end(), has_several)) return;
  users_ = memory.take<TaskId>(spec.tasks.size());
  is_user_ = memory.take<bool>(spec.tasks.size());
}

// The constant changes, or may change. The new values of a producer that is re-initialised are not known. Nor is it
// known with which constants an arriving task was initialised last.
bool ConstantUsers::is_another(ConstantId constant, TaskId user, const SwitchPlan& plan, std::uint32_t before,
                               const MadeConstants* made) const noexcept {
  const std::span<const PortOf> producers = spec_->constants[constant.index].producers;
  if (producers.empty() || !spec_->uses(user, constant)) return false;
  const std::uint32_t from = producer_for(*spec_, constant, user, before);
  const std::uint32_t to = producer_for(*spec_, constant, user, plan.after == kNoSet ? before : plan.after);
  if (producers[to].task == user) return false;  // its own
  if (is_user_[producers[to].task.index]) return true;
  const bool arrives = has(plan.arriving, user);
  for (std::uint32_t k = 0; k < producers.size(); ++k) {
    const bool was_its = arrives ? k != to : k == from && from != to;
    if (was_its && (made == nullptr || made->differ(constant, k, to))) return true;
  }
  return false;
}

// The first constant of the task that is another one.
ConstantId ConstantUsers::changed(TaskId user, const SwitchPlan& plan, std::uint32_t before,
                                  const MadeConstants* made) const noexcept {
  for (std::size_t c = 0; c < spec_->constants.size(); ++c)
    if (is_another(ConstantId(c), user, plan, before, made)) return ConstantId(c);
  return {};
}

std::span<const TaskId> ConstantUsers::find(const SwitchPlan& plan, std::uint32_t before,
                                            const MadeConstants* made) noexcept {
  std::fill(is_user_.begin(), is_user_.end(), false);
  std::size_t n = 0;
  if (!is_any()) return {};
  for (const TaskId task : spec_->init_order) {
    if (!has(plan.arriving, task) && !has(plan.staying, task)) continue;
    is_user_[task.index] = changed(task, plan, before, made).is_valid();
    if (is_user_[task.index]) users_[n++] = task;
  }
  return users_.first(n);
}

ConstantUsers::Found ConstantUsers::find_staying(const SwitchPlan& plan, std::uint32_t before,
                                                 const MadeConstants& made) noexcept {
  for (const TaskId task : find(plan, before, &made))
    if (has(plan.staying, task)) return {task, changed(task, plan, before, &made)};
  return {};
}

}  // namespace chimera
