// SPDX-License-Identifier: Apache-2.0
// Lists the steps of a slow switch.
#include "chimera/runtime/plan/slow_plan.h"

#include <algorithm>

namespace chimera {

SlowCourse::SlowCourse(std::span<const SlowStep> steps) noexcept : steps_(steps) {
  const auto count = [steps](SlowAct act) {
    const auto is_its = [act](const SlowStep& step) { return step.act == act; };
    return static_cast<std::size_t>(std::count_if(steps.begin(), steps.end(), is_its));
  };
  n_checks_ = count(SlowAct::kCheck);
  const auto is_reinit = [](const SlowStep& step) { return step.act == SlowAct::kReinit; };
  first_reinit_ = static_cast<std::size_t>(std::find_if(steps.begin(), steps.end(), is_reinit) - steps.begin());
  end_of_reinits_ = first_reinit_ + count(SlowAct::kReinit);
}

std::size_t SlowCourse::undone_with(std::size_t left) const noexcept {
  const std::size_t step = left - 1;
  const bool is_reinit = step >= first_reinit_ && step < end_of_reinits_;
  return is_reinit ? first_reinit_ + end_of_reinits_ - 1 - step : step;
}

std::optional<std::size_t> SlowCourse::turn_at(std::uint16_t run) const noexcept {
  const bool is_back = (run & TurnWord::kBack) != 0;
  const std::size_t done = run & ~std::uint32_t{TurnWord::kBack};
  if (done > steps_.size() || steps_.empty() || (is_back && done <= n_checks_)) return std::nullopt;
  return is_back ? undone_with(done) : std::min(done, steps_.size() - 1);
}

void SlowPlanner::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  spec_ = &spec;
  rivals_.prepare(spec, memory);
  users_.prepare(spec, memory);
  steps_ = memory.take<SlowStep>(5 * spec.tasks.size());  // an arriving task has at most four, a leaving rival two
}

void SlowPlanner::add(SlowAct act, std::span<const TaskId> tasks) noexcept {
  for (const TaskId task : tasks) steps_[n_++] = {act, task};
}

// The constants that a task will make are not known before it is created: its users may then fail in their step.
std::span<const SlowStep> SlowPlanner::plan(const SwitchPlan& plan, std::uint32_t constants,
                                            std::uint8_t slow) noexcept {
  n_ = 0;
  const bool has_resources = (slow & kSlowForResource) != 0;
  const std::span<const TaskId> users = users_.find(plan, constants, nullptr);
  for (const TaskId user : users)
    if (!has_resources || !rivals_.may_be_absent(user)) steps_[n_++] = {SlowAct::kCheck, user};
  add(SlowAct::kOff, plan.leaving);
  if (has_resources) add_resources(plan);
  add(SlowAct::kReinit, users);
  add(SlowAct::kOn, plan.arriving);
  return steps_.first(n_);
}

void SlowPlanner::add_resources(const SwitchPlan& plan) noexcept {
  const auto order = spec_->init_order;
  for (std::size_t i = order.size(); i-- > 0;) {
    const auto is_its = [&](TaskId arriving) { return rivals_.are(arriving, order[i]); };
    if (std::any_of(plan.arriving.begin(), plan.arriving.end(), is_its)) steps_[n_++] = {SlowAct::kKill, order[i]};
  }
  for (const TaskId task : order) {
    const bool arrives = std::find(plan.arriving.begin(), plan.arriving.end(), task) != plan.arriving.end();
    if (arrives && rivals_.may_be_absent(task)) steps_[n_++] = {SlowAct::kSpawn, task};
  }
}

Nanoseconds flag_lead(const ApplicationSpec& spec, const TaskBits& on) noexcept {
  Nanoseconds lead;
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
    const TaskSpec& task = spec.tasks[t];
    if (task.is_hardware && !task.aperiodic && on.has(TaskId(t))) lead = std::max(lead, task.period);
  }
  return lead;
}

}  // namespace chimera
