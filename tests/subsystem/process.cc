// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/process.h"

#include <algorithm>

#include "tests/subsystem/driver.h"
#include "tests/subsystem/judge.h"
#include "tests/subsystem/keeper.h"

namespace chimera::simulated {

Process::Process(ManagerState& world, RtpuId id)
    : world_(world), id_(id), words_(world.n_tasks()), half_on_(world.n_tasks()) {}

void Process::later(Nanoseconds from, Nanoseconds to, std::function<void()> what) {
  at(world_.now() + world_.chance.between(from, to), std::move(what));
}

void Process::at(Nanoseconds when, std::function<void()> what) {
  world_.agenda.at(when, [this, life = life_, what = std::move(what)] {
    if (!is_alive_ || is_hung_ || life_ != life) return;
    if (world_.now() < stalled_until_) at(stalled_until_, what);
    else what();
  });
}

void Process::stall() {
  if (!is_alive_ || is_hung_) return;
  world_.note("process stalls", id_.index);
  world_.tally.count("stall");
  const Nanoseconds until = world_.now() + world_.chance.between(milliseconds(500), milliseconds(4500));
  stalled_until_ = std::max(stalled_until_, until);
}

// ---- life and death ----

void Process::start(std::uint32_t incarnation) {
  world_.note("process starts", id_.index, incarnation);
  is_alive_ = true;
  is_hung_ = is_serving_ = is_busy_ = flag_ = look_is_due_ = false;
  incarnation_ = incarnation;
  stalled_until_ = {};
  manager_ = 0;
  next_manager_ = world_.driver->is_alive() ? world_.driver->life() : 0;
  letters_.clear();
  service_.clear();
  notes_.clear();
  for (TaskStatus& word : words_) word = {State::kNotCreated, false, incarnation};
  half_on_.assign(words_.size(), false);
  later(milliseconds(1), milliseconds(20), [this] { serve(); });
}

void Process::serve() {
  if (passes(Point::kStarting, "death starting")) return;
  is_serving_ = true;
  look_soon();
  try_attach();
}

void Process::meet(std::uint32_t manager) {
  next_manager_ = manager;
  if (is_alive_ && !is_hung_) later(microseconds(100), milliseconds(3), [this] { try_attach(); });
}

// Between two edges only: drops the posts of the old manager that are not handled yet.
void Process::try_attach() {
  if (!is_serving_ || is_busy_ || next_manager_ == manager_) return;
  const auto old = [this](const Letter& letter) { return letter.manager != 0 && letter.manager != next_manager_; };
  const std::size_t dropped = std::erase_if(letters_, old);
  if (dropped > 0) world_.tally.count("posts of a dead manager dropped");
  manager_ = next_manager_;
  world_.driver->serves(id_, incarnation_, manager_);
  poke();
}

bool Process::is_sent(Signal signal, TaskId task) const noexcept {
  const auto is_it = [&](const Letter& letter) {
    return letter.signal == signal && letter.manager == manager_ &&
           std::find(letter.tasks.begin(), letter.tasks.end(), task) != letter.tasks.end();
  };
  return (is_busy_ && is_it(work_.letter)) || std::any_of(letters_.begin(), letters_.end(), is_it);
}

void Process::die(const std::string& point) {
  if (!is_alive_) return;
  world_.note("process dies", id_.index, incarnation_);
  world_.tally.count(is_hung_ ? "death of a hung one" : point);
  world_.judge->process_dies(id_);
  if (!service_.empty()) world_.tally.count("death with work in service");
  if (!world_.driver->is_alive()) world_.tally.count("death without a manager");
  ++world_.deaths;
  ++life_;
  is_alive_ = is_hung_ = false;
  doom_ = Point::kNone;
  static const char* const kCauses[] = {"ended by signal 11 (SIGSEGV) in t3.cycle; core dumped",
                                        "ended by signal 9 (SIGKILL)", "ended with exit status 3 in t1.init"};
  cause_ = kCauses[world_.chance.below(3)];
  world_.keeper->dies(id_);
}

void Process::hang(const char* point) {
  if (!is_alive_ || is_hung_) return;
  world_.note("process hangs", id_.index);
  world_.tally.count(point);
  world_.judge->process_hangs();
  ++life_;
  is_hung_ = true;
  doom_ = Point::kNone;
  world_.agenda.after(world_.chance.between(milliseconds(100), seconds(4)), [this, incarnation = incarnation_] {
    if (is_hung_ && incarnation_ == incarnation) die("death of a hung one");
  });
}

// True: it is dead or hangs now.
bool Process::passes(Point point, const char* name) {
  if (doom_ != point) return false;
  if (doom_hangs_) hang("hang in a method");
  else die(name);
  return true;
}

// ---- signals ----

void Process::receive(Letter letter) {
  if (!is_alive_) return;
  if (letter.signal == Signal::kOff || letter.signal == Signal::kKill)
    for (TaskId task : letter.tasks) world_.judge->wanted_down(task);
  letters_.push_back(std::move(letter));
  poke();
}

void Process::request(TaskId from, TaskId target) {
  world_.judge->requested(target);
  notes_.emplace_back(subsystem::Requested{target, Signal::kOn, from});
  world_.driver->poke();
}

// A signal waits until the running method of its task ends. Signals of one task keep their order.
bool Process::is_blocked(const Letter& letter, std::size_t before) const {
  return std::any_of(letter.tasks.begin(), letter.tasks.end(), [&](TaskId task) {
    if (word(task).in_service) return true;
    for (std::size_t l = 0; l < before; ++l)
      if (std::find(letters_[l].tasks.begin(), letters_[l].tasks.end(), task) != letters_[l].tasks.end()) return true;
    return false;
  });
}

void Process::poke() {
  if (!is_alive_ || is_hung_ || is_busy_ || !is_serving_) return;
  for (std::size_t l = 0; l < letters_.size(); ++l) {
    if (is_blocked(letters_[l], l)) continue;
    work_ = {};
    work_.letter = std::move(letters_[l]);
    letters_.erase(letters_.begin() + static_cast<std::ptrdiff_t>(l));
    is_busy_ = true;
    later(microseconds(20), milliseconds(1), [this] { begin(); });
    return;
  }
}

void Process::begin() {
  const Letter& mine = work_.letter;
  const auto n = mine.tasks.size();
  work_.in_service.assign(n, false);
  std::size_t wrong = n;
  for (std::size_t i = 0; i < n; ++i) {
    const TaskId task = mine.tasks[i];
    const bool aperiodic = world_.plan.spec.tasks[task.index].aperiodic;
    const State state = word(task).state;
    world_.tally.count_signal(state, mine.signal, aperiodic);
    world_.note("takes", static_cast<int>(mine.signal), task.index, static_cast<int>(state));
    work_.before.push_back(state);
    if (is_half_on(task) && mine.signal == Signal::kOff) continue;
    if (wrong == n && next(state, mine.signal, aperiodic).kind == Next::Kind::kImpossible) wrong = i;
  }
  if (wrong == n) return next_task();
  for (std::size_t i = 0; i < n; ++i) {
    const State state = work_.before[i];
    report(mine, mine.tasks[i], false, i == wrong ? Refusal::kState : Refusal::kNone, state, state);
  }
  end_work();
}

void Process::next_task() {
  if (work_.index > 0 && passes(Point::kInsideList, "death inside a list")) return;
  if (work_.index == work_.letter.tasks.size()) return finish();
  const TaskId task = work_.letter.tasks[work_.index];
  const bool aperiodic = world_.plan.spec.tasks[task.index].aperiodic;
  if (is_half_on(task) && work_.letter.signal == Signal::kOff) return walk(task, Step::kOff);
  const Next at = next(word(task).state, work_.letter.signal, aperiodic);
  if (at.kind != Next::Kind::kStep) {  // a wakeup that is ignored
    ++work_.index;
    return next_task();
  }
  if (at.step == Step::kInit || at.step == Step::kKill) {
    work_.in_service[work_.index] = true;
    errand(task, at.step, work_.letter, work_.before[work_.index]);
    ++work_.index;
    return next_task();
  }
  walk(task, at.step);
}

void Process::walk(TaskId task, Step step) {
  later(microseconds(10), microseconds(300), [this, task, step] {
    if (passes(Point::kBeforeStep, "death before a step")) return;
    const Answer answer = draw(step);
    if (step == Step::kOn || step == Step::kOff) half_on_[task.index] = answer == Answer::kNotYet;
    if (answer == Answer::kNotYet) work_.is_not_ready = true;
    const Next at = rule(step).next[static_cast<int>(answer)];
    if (at.kind == Next::Kind::kState) publish(task, at.state, false);
    if (passes(Point::kAfterStep, "death after a step")) return;
    if (at.kind == Next::Kind::kState) return walked(task, at.state);
    if (at.step != Step::kKill) return walk(task, at.step);
    publish(task, State::kOff, true);
    work_.in_service[work_.index] = true;
    errand(task, Step::kKill, work_.letter, work_.before[work_.index]);
    ++work_.index;
    next_task();
  });
}

void Process::walked(TaskId, State state) {
  if (work_.has_failed) {  // one of the list that goes OFF again
    work_.undo.pop_back();
  } else if (work_.letter.signal == Signal::kOn && state != State::kOn) {
    work_.has_failed = true;
    work_.failed = work_.index;
    if (work_.is_not_ready) return finish();
    for (std::size_t i = 0; i < work_.index; ++i) work_.undo.push_back(i);
  } else {
    ++work_.index;
    return next_task();
  }
  if (!work_.undo.empty()) return walk(work_.letter.tasks[work_.undo.back()], Step::kOff);
  finish();
}

void Process::finish() {
  if (work_.letter.command != 0 && passes(Point::kBeforeReport, "death before a report")) return;
  for (std::size_t i = 0; i < work_.letter.tasks.size(); ++i) {
    if (work_.in_service[i]) continue;
    const TaskId task = work_.letter.tasks[i];
    const bool at_fault = work_.has_failed && work_.failed == i;
    const bool is_done = !work_.has_failed || (work_.is_not_ready && i < work_.failed);
    const Refusal why = !at_fault ? Refusal::kNone : work_.is_not_ready ? Refusal::kNotYet : Refusal::kFault;
    report(work_.letter, task, is_done, why, work_.before[i], word(task).state);
  }
  if (work_.letter.command != 0 && passes(Point::kAfterReport, "death after a report")) return;
  end_work();
}

void Process::end_work() {
  is_busy_ = false;
  try_attach();
  poke();
}

}  // namespace chimera::simulated
