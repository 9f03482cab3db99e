// SPDX-License-Identifier: Apache-2.0
// The service thread of a simulated rtpu, and what others see of it.
#include "tests/subsystem/driver.h"
#include "tests/subsystem/judge.h"
#include "tests/subsystem/process.h"

namespace chimera::simulated {

void Process::errand(TaskId task, Step step, const Letter& letter, State before) {
  publish(task, word(task).state, true);
  service_.push_back({task, step, letter, before});
  if (service_.size() == 1) run_errand();
}

void Process::run_errand() {
  const bool is_slow = world_.chance.permille(10);
  const Nanoseconds from = is_slow ? seconds(2) : milliseconds(1);
  later(from, from + milliseconds(30), [this] {
    if (passes(Point::kInService, "death with work in service")) return;
    errand_step(service_.front().step);
  });
}

void Process::errand_step(Step step) {
  const Next at = rule(step).next[static_cast<int>(draw(step))];
  if (at.kind == Next::Kind::kStep) {
    later(microseconds(100), milliseconds(2), [this, next = at.step] { errand_step(next); });
    return;
  }
  const Errand done = service_.front();
  publish(done.task, at.state, false);
  report(done.letter, done.task, true, Refusal::kNone, done.before, at.state);
  service_.pop_front();
  if (!service_.empty()) run_errand();
  poke();
}

// ---- what others see ----

Answer Process::draw(Step step) {
  Answer answer = Answer::kOk;
  const auto may = [&](unsigned percent, Answer other) {
    if (answer == Answer::kOk && !world_.is_calm && world_.chance.percent(percent)) answer = other;
  };
  switch (step) {
    case Step::kInit: may(4, Answer::kFault); break;
    case Step::kKillAfterInit: may(30, Answer::kFault); break;
    case Step::kOn: may(5, Answer::kFault), may(5, Answer::kNotYet); break;
    case Step::kSync: may(10, Answer::kFault), may(30, Answer::kNoEvent); break;
    case Step::kCycle: may(15, Answer::kFault), may(15, Answer::kAborted); break;
    case Step::kErrorToOff:
    case Step::kErrorToOn: may(40, Answer::kFault); break;
    default: may(8, Answer::kFault); break;
  }
  world_.tally.count_answer(step, answer);
  world_.note("step", static_cast<int>(step), static_cast<int>(answer));
  return answer;
}

void Process::publish(TaskId task, State state, bool in_service) {
  words_[task.index] = {state, in_service, incarnation_};
  world_.note("word", task.index, static_cast<int>(state), in_service);
  world_.judge->changed();
  world_.judge->published(task, state);
  world_.driver->poke();
}

void Process::report(const Letter& letter, TaskId task, bool accepted, Refusal why, State before, State after) {
  if (letter.command == 0) return;
  const std::string text = why == Refusal::kFault ? "said no" : "";
  notes_.emplace_back(subsystem::Reported{letter.command, task, letter.signal, accepted, why, before, after, text});
  world_.driver->poke();
}

void Process::look_soon() {
  if (!is_alive_ || is_hung_ || !is_serving_ || look_is_due_) return;
  look_is_due_ = true;
  later(microseconds(50), milliseconds(1), [this] { look(); });
}

void Process::look() {
  look_is_due_ = false;
  seen_changes_ = world_.changes;
  const bool was_up = flag_;
  flag_ = !world_.variables.is_legal(world_.judge->on_as_seen());
  if (flag_ != was_up) world_.tally.count(flag_ ? "flag up" : "flag down");
}

}  // namespace chimera::simulated
