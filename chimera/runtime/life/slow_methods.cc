// SPDX-License-Identifier: Apache-2.0
// Hands methods that may block to the service thread, and runs them there.
#include "chimera/runtime/life/slow_methods.h"

#include "chimera/runtime/task_word.h"

namespace chimera {

void SlowMethods::prepare(std::span<Task> tasks, std::span<TaskHost> hosts, TaskMethods& methods, Service* service,
                          std::atomic<std::uint32_t>& serving, SetupMemory& memory) {
  tasks_ = tasks;
  hosts_ = hosts;
  methods_ = &methods;
  service_ = service;
  serving_ = &serving;
  asked_ = memory.take<Asked>(is_there() ? tasks.size() : 0);
}

void SlowMethods::ask(Task& task, const Asked& asked) noexcept {
  asked_[task.id.index] = asked;
  if (task.state == State::kOn) task.state = State::kOff;
  task.standing = Standing::kInService;
  service_->ask(task.id);
}

void SlowMethods::run(TaskId id, JobClock& clock) {
  Task& task = tasks_[id.index];
  Asked& asked = asked_[id.index];
  std::atomic<std::uint32_t>* const running = task.running;
  hosts_[id.index].clock = &clock;
  task.running = serving_;
  asked.outcome.is_construction = asked.is_construction;
  const Nanoseconds began = clock.now();
  if (asked.is_construction) {
    task.running->store(TaskWord(id, Method::kInit).word(), std::memory_order_relaxed);
    asked.outcome.answer = methods_->construct(task, began);
  } else {
    asked.outcome.answer = methods_->call(task, asked.method, began);
    asked.outcome.used = clock.now() - began;
    if (asked.method == Method::kKill) methods_->destroy(task);
  }
  serving_->store(0, std::memory_order_relaxed);
  task.running = running;
  hosts_[id.index].clock = nullptr;
}

SlowMethods::Outcome SlowMethods::finish(Task& task) noexcept {
  task.standing = Standing::kPlain;
  return asked_[task.id.index].outcome;
}

}  // namespace chimera
