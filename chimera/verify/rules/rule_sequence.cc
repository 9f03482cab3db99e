// SPDX-License-Identifier: Apache-2.0
// Rules on the key `sequence` that need the tasks. description/sequence.cc judges the form: each step ends in bounded
// time, and the one behind it is reached, if its condition can hold.
#include <algorithm>
#include <charconv>

#include "chimera/description/draft_values.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

const SetModel* set_of_step(Model& model, const DraftStep& step) {
  const auto found = std::ranges::find(model.sets, step.configuration.text, &SetModel::name);
  if (found != model.sets.end()) return &*found;
  std::vector<std::string> names;
  for (const SetModel& set : model.sets) names.push_back(set.name);
  const std::string near = nearest(step.configuration.text, names);
  if (!step.configuration.empty())
    model.error("configuration-unknown", step.configuration.at,
                "'switch' of " + model.draft.sequence->say(step) + " names the configuration '" +
                    step.configuration.text + "', which is not there",
                step.configuration.text, listed(names), near, near.empty() ? "there are: " + listed(names) : "");
  return nullptr;
}

std::string plain_number(double number) {
  char out[32];
  return {out, std::to_chars(out, out + sizeof out, number).ptr};
}

/// A value beyond the range is refused before; here the relation excludes the end of the range.
void check_reach(Model& model, const DraftCondition& draft, const JudgedCondition& judged, const std::string& what) {
  const PortDescriptor& port = *judged.port->declared;
  const SafeCondition& condition = judged.condition;
  const bool is_below = condition.comparison == Relation::kLess && condition.limit <= port.min;
  const bool is_above = condition.comparison == Relation::kMore && condition.limit >= port.max;
  if (!port.has_range || (!is_below && !is_above)) return;
  model.error("sequence-condition", draft.variable.at,
              what + " can never hold: '" + draft.variable.text + "' is " + plain_number(port.min) + " to " +
                  plain_number(port.max) + (judged.port->unit_text == "1" ? "" : " " + judged.port->unit_text),
              draft.value.text, "a value that it can have", {}, is_below ? "write <= for <" : "write >= for >");
}

}  // namespace

void check_sequence(Model& model) {
  if (!model.draft.sequence) return;
  for (const DraftStep& step : model.draft.sequence->steps) {
    const SetModel* set = set_of_step(model, step);
    if (!step.until) continue;
    const std::string what = "'until' of " + model.draft.sequence->say(step);
    const auto judged = judge_condition(model, *step.until, {what, set, true});
    if (judged) check_reach(model, *step.until, *judged, what);
  }
}

}  // namespace chimera
