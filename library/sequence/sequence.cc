// SPDX-License-Identifier: Apache-2.0
// Goes through the configurations of an application, step by step. The key `sequence` of a description gives its ports;
// README.md is the data sheet, steps.h the decisions.
#include <array>
#include <cmath>

#include "chimera/task/component.h"
#include "chimera/task/number_at.h"
#include "library/sequence/step.h"
#include "library/sequence/steps.h"

using namespace chimera;
using library::SequenceInput, library::SequenceState, library::SequenceStep, library::SequenceSteps, library::Step;

namespace {

constexpr std::size_t kMost = SequenceSteps::kMost;

// In the order of `relation`: < <= > >= == !=. NaN holds nothing.
bool holds(double value, std::int32_t relation, double level) {
  if (std::isnan(value)) return false;
  const bool answers[] = {value < level, value <= level, value > level, value >= level, value == level, value != level};
  return answers[relation];
}

Nanoseconds duration(double seconds) { return {static_cast<std::int64_t>(std::llround(seconds * 1e9))}; }

struct Sequence {
  Many<In<Any[]>> value{"value*", "U", "[n...<=1024]", type = "T", intermittent,
                        doc = "Variables of the conditions, in the order of the steps."};
  In<std::int32_t> sequence_go{"sequence_go", "1", range(0, kMost), doc = "0 pauses; N goes to step N."};
  Out<std::int32_t> sequence_step{"sequence_step", "1", initial = 0, doc = "The present step, from 1; 0: none yet."};
  Out<double> sequence_waited{"sequence_waited", "s", initial = 0.0,
                              doc = "Time since the step began, or since its switch is requested."};
  Out<bool> sequence_failed{"sequence_failed", "1", initial = false, doc = "A step failed, and the sequence stopped."};
  Out<std::int32_t> sequence_state{"sequence_state", "1", initial = 7,
                                   doc = "0 paused, 1 switches, 2 runs, 3 waits for Go, 4 interrupted, 5 failed, "
                                         "6 done, 7 begins."};
  Out<Text<72>[]> sequence_steps{"sequence_steps", "1", "[steps<=16]", doc = "Names of the steps."};
  Many<InConst<double>> level{"level*", "U", initial = 0.0, doc = "Value that each condition compares with."};
  Many<InConst<Text<72>>> configuration{"configuration*", "1", component_api::names::configuration,
                                        doc = "Configuration of each step."};
  InConst<Step[]> step{"step", "1", "[steps<=16]", doc = "The steps."};
  InConst<bool> repeat{"repeat", "1", initial = false, doc = "Begins again after the last step."};

  Outcome init() {
    if (step.size() != configuration.size()) return fault("`step` and `configuration` differ in length");
    for (std::size_t i = 0; i < step.size(); ++i)
      if (const char* why = take(step[i], i)) return fault(why);
    machine_.prepare({steps_.data(), step.size()}, *repeat);
    is_first_on_ = true;
    seen_go_ = kNever;
    return ok();
  }
  void on(Cycle c) {
    if (machine_.state() == SequenceState::kBegins && sequence_step.inherited() != kNever)
      machine_.restore(*sequence_step, static_cast<SequenceState>(*sequence_state));
    machine_.on(c.now(), is_first_on_ && c.incarnation() > 1);
    // A Go from before this life of the task has had its effect; a pause still counts.
    if (seen_go_ == kNever && machine_.state() != SequenceState::kBegins && sequence_go.valid())
      seen_go_ = *sequence_go == 0 ? kNever : published(sequence_go, c);
    is_first_on_ = false;
    for (std::size_t i = 0; i < step.size(); ++i) sequence_steps[i] = step[i].name;
    show(c);
  }
  void cycle(Cycle c) {
    const SequenceInput in{c.now(), c.configuration(), c.illegal(), new_go(c), holds_now(c)};
    machine_.cycle(in);
    if (machine_.request() >= 0) c.request(configuration[static_cast<std::size_t>(machine_.request())]->c_str());
    if (machine_.note()[0] != '\0') c.note(machine_.note());
    show(c);
  }

 private:
  // Returns what is wrong with the step.
  const char* take(const Step& from, std::size_t i) {
    const bool has_condition = from.input >= 0;
    const auto input = static_cast<std::size_t>(from.input);
    if (has_condition && (input >= value.size() || input >= level.size())) return "a step has no input of that number";
    if (has_condition && (from.element < 0 || static_cast<std::size_t>(from.element) >= value[input].size()))
      return "a condition names an element that its variable does not have";
    if (from.relation < 0 || from.relation > 5) return "a condition has no such comparison";
    if (from.otherwise >= static_cast<std::int32_t>(step.size())) return "`otherwise` names no step";
    if (!(from.within > 0 && from.within < 9e9) || !(from.wait >= 0 && from.wait < 9e9))
      return "a step needs `within` above 0, and `wait` of 0 or more";
    steps_[i] = {from.name.view(), configuration[i]->view(), duration(from.within), duration(from.wait),
                 has_condition,    from.otherwise,           from.confirm,          from.reentry};
    return nullptr;
  }

  template <class Port>
  static Nanoseconds published(const Port& port, Cycle c) {
    return c.now() - port.age();
  }

  std::int32_t new_go(Cycle c) {
    if (!sequence_go.valid()) return -1;
    const Nanoseconds at = published(sequence_go, c);
    if (at == seen_go_) return -1;
    seen_go_ = at;
    return *sequence_go;
  }

  // A value counts if it was published since the step began.
  bool holds_now(Cycle c) const {
    if (machine_.state() != SequenceState::kRuns) return false;
    const Step& present = step[machine_.running()];
    if (present.input < 0) return false;
    const auto& from = value[static_cast<std::size_t>(present.input)];
    if (!from.valid() || published(from, c) < machine_.began()) return false;
    const std::size_t at = static_cast<std::size_t>(present.element) * from.element_size();
    const double number = number_at(from.element_type(), from.bytes().data() + at);
    return holds(number, present.relation, *level[static_cast<std::size_t>(present.input)]);
  }

  void show(Cycle c) {
    *sequence_step = machine_.step();
    *sequence_waited = to_seconds(machine_.waited(c.now()));
    *sequence_failed = machine_.state() == SequenceState::kFailed;
    *sequence_state = static_cast<std::int32_t>(machine_.state());
  }

  SequenceSteps machine_;
  std::array<SequenceStep, kMost> steps_;
  Nanoseconds seen_go_ = kNever;  // the publication of sequence_go that was obeyed last
  bool is_first_on_ = true;
};

CHIMERA_COMPONENT(Sequence, "sequence", "Goes through the configurations of an application, step by step.",
                  rate = 100.0);

}  // namespace
