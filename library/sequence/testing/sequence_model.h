// SPDX-License-Identifier: Apache-2.0
// The rules of a sequence once more: each answer comes from the whole history, without a memory of its own. And a
// machine with persons, errors, slow switches and emergency stops by seed, in which both must agree.
#pragma once

#include <array>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "library/sequence/steps.h"

namespace chimera::library {

/// Answers from the history of all cycles.
class SequenceModel {
 public:
  struct Cycle {
    SequenceInput in;
    SequenceState state = SequenceState::kBegins;
    std::size_t step = 0;
    bool has_entered = false, has_begun = false;
    int request = -1;
    bool is_stable() const { return !in.in_force.empty() && !in.illegal; }
  };

  SequenceModel(const std::vector<SequenceStep>& steps, bool repeats) : steps_(steps), repeats_(repeats) {}

  const Cycle& cycle(const SequenceInput& in) {
    Cycle now = all_.empty() ? Cycle{} : all_.back();
    now.in = in;
    now.has_entered = now.has_begun = false;
    now.request = -1;
    all_.push_back(now);
    now_ = &all_.back();
    go();
    disturb();
    move();
    return *now_;
  }

 private:
  using State = SequenceState;

  bool is_at(std::size_t step) const { return steps_[step].configuration == now_->in.in_force; }
  void enter(std::size_t step, bool is_confirmed) {
    now_->step = step;
    now_->has_entered = true;
    now_->state = steps_[step].confirm && !is_confirmed ? State::kWaitsForGo : State::kSwitches;
  }

  void go() {
    const int wanted = now_->in.go;
    const bool is_step = wanted > 0 && static_cast<std::size_t>(wanted) <= steps_.size();
    if (wanted == 0) now_->state = State::kPaused;
    else if (is_step && now_->state != State::kBegins) return enter(static_cast<std::size_t>(wanted - 1), true);
    if (now_->state != State::kBegins || !now_->is_stable()) return;
    for (std::size_t i = all_.size(); i-- > 0;) {
      const int asked = all_[i].in.go;
      if (asked > 0 && static_cast<std::size_t>(asked) <= steps_.size())
        return enter(static_cast<std::size_t>(asked - 1), false);
    }
  }

  /// The last cycle for which that holds.
  template <class Is>
  std::size_t last(Is is) const {
    for (std::size_t i = all_.size(); i-- > 0;)
      if (is(all_[i])) return i;
    return 0;
  }
  std::size_t entered() const { return last([](const Cycle& c) { return c.has_entered; }); }
  std::size_t begun() const { return last([](const Cycle& c) { return c.has_begun; }); }
  /// Since the step was entered or has begun, all was well once, and then not: no configuration, or the flag.
  bool was_disturbed(bool by_loss) const {
    bool was_well = false;
    for (std::size_t i = std::max(entered(), begun()); i < all_.size(); ++i) {
      was_well = was_well || all_[i].is_stable();
      if (was_well && (by_loss ? all_[i].in.in_force.empty() : !all_[i].is_stable())) return true;
    }
    return false;
  }
  std::string_view stable_before() const {
    for (std::size_t i = all_.size() - 1; i-- > 0;)
      if (all_[i].is_stable()) return all_[i].in.in_force;
    return {};
  }
  bool is_foreign() const {
    if (now_->has_entered || is_at(now_->step) || now_->in.in_force == stable_before()) return false;
    for (std::size_t i = all_.size(); i-- > 0 && !all_[i].has_begun;)
      if (all_[i].request >= 0 && is_at(static_cast<std::size_t>(all_[i].request))) return false;
    return true;
  }

  void disturb() {
    const bool is_stable = now_->is_stable();
    if (now_->state == State::kRuns && is_stable && !is_at(now_->step)) now_->state = State::kPaused;
    if (now_->state == State::kRuns && !is_stable) {
      now_->state = State::kInterrupted;
      return;
    }
    if (now_->state == State::kWaitsForGo && is_stable && is_foreign()) now_->state = State::kPaused;
    if (now_->state == State::kSwitches && is_stable && !is_at(now_->step)) {
      if (is_foreign()) now_->state = State::kPaused;
      else if (was_disturbed(false)) now_->state = State::kInterrupted;
    }
    if (now_->state != State::kInterrupted || !is_stable) return;
    std::vector<std::size_t> may;
    for (std::size_t i = 0; i < steps_.size(); ++i)
      if (steps_[i].reentry && is_at(i)) may.push_back(i);
    for (const std::size_t i : may)
      if (i == now_->step) may = {i};
    const bool is_person = !was_disturbed(true) && now_->in.in_force != stable_before();
    if (may.size() == 1 && !is_person) enter(may[0], false);
    else now_->state = State::kPaused;
  }

  void fail() {
    const SequenceStep& step = steps_[now_->step];
    if (step.otherwise < 0 || !now_->is_stable()) now_->state = State::kFailed;
    else enter(static_cast<std::size_t>(step.otherwise), false);
  }

  void move() {
    const SequenceStep* step = &steps_[now_->step];
    const Nanoseconds now = now_->in.now;
    if (now_->state == State::kRuns) {
      const Nanoseconds waited = now - all_[begun()].in.now;
      const bool ends = step->has_condition ? now_->in.holds : waited >= step->wait;
      if (ends && now_->step + 1 < steps_.size()) enter(now_->step + 1, false);
      else if (ends && repeats_) enter(0, false);
      else if (ends) now_->state = State::kDone;
      else if (step->has_condition && waited >= step->within) fail();
    }
    if (now_->state != State::kSwitches) return;
    step = &steps_[now_->step];
    if (now_->is_stable() && is_at(now_->step)) {
      now_->has_begun = true;
      now_->state = step->has_condition || step->wait.count > 0 ? State::kRuns : State::kDone;
      return;
    }
    if (!was_disturbed(false) && now - all_[entered()].in.now >= step->within) fail();
    if (now_->state != State::kSwitches || was_disturbed(false) || is_at(now_->step)) return;
    for (std::size_t i = all_.size() - 1; i-- > entered();)
      if (all_[i].request >= 0 && now - all_[i].in.now < seconds(1)) return;
    const bool is_new = all_[entered()].request < 0 || entered() + 1 == all_.size();
    if (is_new || now - all_[entered()].in.now >= seconds(1)) now_->request = static_cast<int>(now_->step);
  }

  const std::vector<SequenceStep>& steps_;
  const bool repeats_;
  std::vector<Cycle> all_;
  Cycle* now_ = nullptr;
};

/// A machine whose configurations change by request, late or never, and by persons and errors.
class SequencePlant {
 public:
  explicit SequencePlant(std::mt19937& random) : random_(random) {}

  std::string_view in_force() const { return lost_ > 0 ? std::string_view{} : present_; }
  bool is_illegal() const { return flag_ > 0; }
  std::size_t pick(std::size_t n) { return random_() % n; }

  void request(std::string_view to) {
    if (pick(4) == 0) return;  // refused
    to_ = to;
    after_ = 1 + pick(8);
    slow_ = pick(3) == 0;
    fails_ = pick(6) == 0;
  }
  void step() {
    if (flag_ > 0 && --flag_ == 0 && !next_.empty()) present_ = next_, next_ = {};
    if (lost_ > 0) --lost_;
    if (after_ > 0 && --after_ == 0) arrive(to_, slow_, fails_);
    const std::size_t event = pick(250);
    if (event == 0) arrive(name(), pick(2) == 0, false);  // a person switches
    if (event == 1) lost_ = 1 + pick(8), flag_ = pick(2) * lost_, after_ = 0;  // an error
    if (event == 2) lost_ = 1 + pick(8), present_ = name(), after_ = 0;  // with a reaction
    if (event == 3) flag_ = 1 + pick(20), next_ = {}, after_ = 0;  // an emergency stop
  }
  std::string_view name() { return kNames[pick(kNames.size())]; }

 private:
  static constexpr std::array<std::string_view, 4> kNames = {"a", "b", "c", "d"};

  void arrive(std::string_view to, bool is_slow, bool fails) {
    if (is_slow) flag_ = 1 + pick(5);
    const std::string_view now = fails ? present_ : to;
    if (is_slow) next_ = now;
    else present_ = now;
  }

  std::mt19937& random_;
  std::string_view present_ = "a", to_, next_;
  std::size_t after_ = 0, flag_ = 0, lost_ = 0;
  bool slow_ = false, fails_ = false;
};

/// "" if machine and model agree in 400 cycles of a sequence by seed.
inline std::string compare_with_model(unsigned seed) {
  std::mt19937 random(seed);
  SequencePlant plant(random);
  const auto pick = [&](std::size_t n) { return random() % n; };
  const auto time = [&](std::size_t most) { return milliseconds(static_cast<std::int64_t>(100 * (1 + pick(most)))); };
  std::vector<SequenceStep> steps(1 + pick(6));
  const bool repeats = pick(2) == 0;
  for (SequenceStep& step : steps) {
    const bool has_condition = pick(2) == 0;
    step = {"step", plant.name(), time(25), has_condition ? Nanoseconds{} : time(10), has_condition,
            static_cast<std::int32_t>(pick(steps.size() + 1)) - 1, pick(8) == 0, pick(3) == 0};
  }
  if (!repeats && pick(2) == 0) steps.back().has_condition = false, steps.back().wait = {};
  SequenceSteps machine;
  machine.prepare(steps, repeats);
  machine.on({}, false);
  SequenceModel model(steps, repeats);
  for (int i = 1; i <= 400; ++i) {
    SequenceInput in{milliseconds(100 * i), plant.in_force(), plant.is_illegal(), i == 1 ? 1 : -1, pick(10) == 0};
    if (pick(40) == 0) in.go = static_cast<std::int32_t>(pick(steps.size() + 2));
    machine.cycle(in);
    const SequenceModel::Cycle& wanted = model.cycle(in);
    const std::size_t step = machine.step() == 0 ? 0 : static_cast<std::size_t>(machine.step() - 1);
    if (machine.state() != wanted.state || step != wanted.step || machine.request() != wanted.request)
      return "cycle " + std::to_string(i) + ": state " + std::to_string(static_cast<int>(machine.state())) + ", step " +
             std::to_string(step) + ", request " + std::to_string(machine.request()) + "; the model " +
             std::to_string(static_cast<int>(wanted.state)) + ", " + std::to_string(wanted.step) + ", " +
             std::to_string(wanted.request);
    if (machine.request() >= 0) plant.request(steps[static_cast<std::size_t>(machine.request())].configuration);
    plant.step();
  }
  return {};
}

}  // namespace chimera::library
