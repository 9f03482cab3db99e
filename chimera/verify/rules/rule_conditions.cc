// SPDX-License-Identifier: Apache-2.0
// Rules on `safe_when` and `until`: a condition compares one number or truth value that exists where it counts.
#include <algorithm>

#include "chimera/description/draft_values.h"
#include "chimera/task/number_at.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/rules/rules.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

// Above this value some whole numbers are not doubles.
constexpr double kLargestWhole = 9007199254740992.0;

/// A condition and its place.
class ConditionJudge {
 public:
  ConditionJudge(Model& model, const DraftCondition& draft, const ConditionPlace& place)
      : model_(model), draft_(draft), place_(place), what_(place.what) {}

  std::optional<JudgedCondition> judge() {
    const VariableModel* variable = find();
    if (variable == nullptr || !is_produced(*variable)) return std::nullopt;
    const LinkedPort& port = judged_port(*variable);
    if (!is_solved(port) || !is_number(port) || !is_one_element(port)) return std::nullopt;
    const SetModel* set = place_.is_until ? &nowhere_ : place_.set;
    const auto bytes = value_bytes(model_, draft_.value, {port, what_, false, set});
    if (!bytes) return std::nullopt;
    const std::uint32_t element = draft_.element.value_or(0);
    const double limit = number_at(*port.type, bytes->data() + std::size_t{element} * port.element_bytes);
    if (*port.type == CHIMERA_INT64 && !(limit > -kLargestWhole && limit < kLargestWhole)) {
      refuse("value-range", "compares with " + draft_.value.text + "; expected less than 2^53",
             draft_.value.text, "a number of at most 53 bits");
      return std::nullopt;
    }
    const auto number = static_cast<std::size_t>(variable - model_.variables.data());
    return JudgedCondition{{{}, element, draft_.comparison, limit}, number, &port};
  }

 private:
  void refuse(std::string_view rule, const std::string& said, const std::string& found, std::string expected,
              std::string near = {}, std::string remedy = {}) {
    model_.error(rule, draft_.variable.at, what_ + ' ' + said, found, std::move(expected), std::move(near),
                 std::move(remedy));
  }

  const VariableModel* find() {
    const std::string& name = draft_.variable.text;
    const VariableModel* found = model_.variable(name);
    const auto has_no_value = [&](const VariableModel& one) {
      return place_.is_until && one.producers.empty() && !one.is_given();
    };
    if (found != nullptr && !found->is_constant && !has_no_value(*found)) return found;
    if (model_.is_incomplete()) return nullptr;
    std::vector<std::string> names;
    for (const VariableModel& one : model_.variables)
      if (!one.is_constant && !has_no_value(one)) names.push_back(one.name);
    const std::string near = nearest(name, names);
    refuse("condition-variable",
           found != nullptr && found->is_constant ? "names '" + name + "', which is a constant and never changes"
                            : "names the variable '" + name + "', which is not there",
           name, "a state variable", near, near.empty() && !names.empty() ? "there are: " + listed(names) : "");
    return nullptr;
  }

  /// True if the operator produces it, or the configuration of the step; of `safe_when`, one from which a switch
  /// to this one can begin.
  bool is_produced(const VariableModel& variable) {
    if (variable.given != nullptr && !variable.consumers.empty()) return true;
    if (model_.is_incomplete() || place_.set == nullptr) return false;
    const auto is_made_in = [&](const SetModel& set) {
      return std::ranges::any_of(variable.producers, [&](PortRef p) { return set.has(p.task); });
    };
    const std::string& name = place_.set->name;
    if (place_.is_until && !is_made_in(*place_.set))
      refuse("condition-variable",
             "can never hold: no task of configuration '" + name + "' produces '" + variable.name + "'", variable.name,
             "a variable of configuration '" + name + "'", {}, "add its producer to '" + name + "', or name another");
    if (place_.is_until) return is_made_in(*place_.set);
    const bool is_elsewhere = std::ranges::any_of(
        model_.sets, [&](const SetModel& other) { return &other != place_.set && is_made_in(other); });
    if (!is_elsewhere)
      refuse("condition-variable",
             "can never hold: no other configuration produces '" + variable.name + "', so it has no value there",
             variable.name, "a variable of another configuration", {},
             "name a variable that is produced where the switch begins");
    return is_elsewhere;
  }

  /// The producer, in the configuration of a step; of an operator variable, a reader with a range if there is one.
  const LinkedPort& judged_port(const VariableModel& variable) const {
    const auto& ports = variable.producers.empty() ? variable.consumers : variable.producers;
    const auto is_best = [&](PortRef one) {
      if (variable.producers.empty()) return model_.port(one).declared->has_range;
      return place_.is_until && place_.set != nullptr && place_.set->has(one.task);
    };
    const auto best = std::ranges::find_if(ports, is_best);
    return model_.port(best == ports.end() ? ports[0] : *best);
  }

  bool is_number(const LinkedPort& port) {
    if (*port.type == CHIMERA_STRING || *port.type == CHIMERA_STRUCT) {
      refuse("condition-variable", "names '" + draft_.variable.text + "', a " + type_text(port) +
             "; expected a number or a truth value", type_text(port), "a number or a truth value");
      return false;
    }
    const bool is_equality = draft_.comparison == Relation::kEqual || draft_.comparison == Relation::kUnequal;
    if (*port.type != CHIMERA_BOOL || is_equality) return true;
    const std::string sign = sign_of(draft_.comparison);
    refuse("condition-bad", "compares '" + draft_.variable.text + "', a truth value, by " + sign +
           "; expected == or !=", sign, "== or !=");
    return false;
  }

  bool is_one_element(const LinkedPort& port) {
    const std::string& name = draft_.variable.text;
    const std::string shape = shape_text(port.extents);
    const bool is_matrix = port.extents.size() > 1;
    if (is_matrix || (!draft_.element && element_count(port.extents) > 1)) {
      refuse("condition-variable", "names '" + name + "', which has the shape " + shape +
             (is_matrix ? "; expected a number, or an element of a vector" : ""), name,
             "one number", {}, is_matrix ? "" : "name one element: '" + name + "[0]'");
      return false;
    }
    const std::uint32_t length =
        port.extents.empty() ? 1 : port.extents[0].known.value_or(port.extents[0].max);
    if (draft_.element.value_or(0) < length) return true;
    refuse("condition-variable", "names element " + std::to_string(*draft_.element) + " of '" + name + "', which has " +
           std::to_string(length) + ", from 0", std::to_string(*draft_.element), "0 to " + std::to_string(length - 1));
    return false;
  }

  Model& model_;
  const DraftCondition& draft_;
  const ConditionPlace& place_;
  const SetModel nowhere_;  // a fault of `until` stands at no configuration
  std::string what_;
};

}  // namespace

std::optional<JudgedCondition> judge_condition(Model& model, const DraftCondition& draft, const ConditionPlace& place) {
  return ConditionJudge(model, draft, place).judge();
}

void check_conditions(Model& model) {
  for (std::size_t i = 0; i < model.draft.configurations.size(); ++i) {
    SetModel& set = model.sets[i];
    const auto& safe_when = model.draft.configurations[i].safe_when;
    if (!safe_when) continue;
    const auto judged = judge_condition(model, *safe_when, {"'safe_when' of configuration '" + set.name + "'", &set});
    if (!judged) continue;
    set.safe_when = judged->condition;
    set.safe_variable = judged->variable;
  }
}

}  // namespace chimera
