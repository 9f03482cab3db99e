// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/face.h"

#include <algorithm>

#include "tests/subsystem/driver.h"
#include "tests/subsystem/judge.h"
#include "tests/subsystem/process.h"

namespace chimera::simulated {

void Face::live() {
  world_.agenda.after(world_.chance.between(milliseconds(10), milliseconds(400)), [this] {
    if (world_.is_calm) return;
    if (!is_waiting_) ask_by_chance();
    live();
  });
}

void Face::ask(Signal signal, std::vector<TaskId> tasks) {
  is_waiting_ = true;
  asked_of_ = 0;
  asked_at_ = world_.now();
  signal_ = signal;
  tasks_ = std::move(tasks);
  ++world_.signals;
  for (TaskId task : tasks_)
    if (wants_down(task)) world_.judge->asked_down(task, signal);
    else world_.judge->asked_up(task);
  world_.note("face asks", index_, static_cast<int>(signal));
  world_.driver->poke();
}

void Face::let_in(std::uint32_t manager) {
  if (asked_of_ != 0) world_.tally.count("command again");
  asked_of_ = manager;
}

void Face::answered(const subsystem::CommandAnswer& answer) {
  world_.tally.count(answer.is_accepted() ? "command answered yes" : "command answered no");
  if (answer.refusal.kind == subsystem::RefusalKind::kNoAnswer) world_.tally.count("no answer");
  is_waiting_ = false;
  last_ = answer;
}

bool Face::wants_down(TaskId task) const noexcept {
  return is_waiting_ && (signal_ == Signal::kOff || signal_ == Signal::kKill) &&
         std::find(tasks_.begin(), tasks_.end(), task) != tasks_.end();
}

std::vector<TaskId> Face::in_state(State state, bool starters_only) const {
  std::vector<TaskId> tasks;
  for (std::size_t t = 0; t < world_.n_tasks(); ++t) {
    const auto& start = world_.plan.spec.start;
    if (starters_only && std::find(start.begin(), start.end(), TaskId(t)) == start.end()) continue;
    if (world_.driver->is_alive() && world_.driver->subsystem().state(TaskId(t)) == state) tasks.push_back(TaskId(t));
  }
  return tasks;
}

// `off` for a producer and, in the same moment through another face, `on` for one that may take its place.
bool Face::swap() {
  const auto other = std::find_if(world_.faces.begin(), world_.faces.end(), [this](const auto& face) {
    return face.get() != this && !face->is_waiting();
  });
  const auto candidates = in_state(State::kOff, false);
  if (other == world_.faces.end() || candidates.empty()) return false;
  const TaskId task = world_.chance.of(candidates);
  auto rivals = world_.judge->rivals(task);
  if (rivals.empty()) return false;
  ask(Signal::kOff, std::move(rivals));
  (*other)->ask(Signal::kOn, {task});
  return true;
}

// Half of it repairs, so that something is left to break; a part is nonsense.
void Face::ask_by_chance() {
  Chance& chance = world_.chance;
  static constexpr Signal kAll[] = {Signal::kSpawn, Signal::kOn,    Signal::kOff,
                                    Signal::kKill,  Signal::kClear, Signal::kReinit};
  static constexpr State kLegal[] = {State::kNotCreated, State::kOff,   State::kOn,
                                     State::kOff,        State::kError, State::kOn};
  const std::size_t kind = chance.below(10);
  if (kind < 4) {  // repair
    const std::size_t which = chance.below(4);
    const Signal signal = which == 0 ? Signal::kSpawn : which == 1 ? Signal::kClear : Signal::kOn;
    const State state = which == 0 ? State::kNotCreated : which == 1 ? State::kError : State::kOff;
    auto tasks = in_state(state, signal == Signal::kOn);
    if (!tasks.empty()) return ask(signal, std::move(tasks));
  }
  if (kind == 4 && swap()) return;
  const std::size_t s = chance.below(6);
  auto candidates = in_state(kLegal[s], false);
  if (kind == 9 || candidates.empty())
    for (std::size_t t = 0; t < world_.n_tasks(); ++t) candidates.push_back(TaskId(t));
  std::vector<TaskId> tasks;
  for (std::size_t n = 1 + chance.below(3); n > 0; --n) tasks.push_back(chance.of(candidates));
  ask(kAll[s], std::move(tasks));
}

}  // namespace chimera::simulated
