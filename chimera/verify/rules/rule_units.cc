// SPDX-License-Identifier: Apache-2.0
// Rules on units: linked ports can be converted into each other, and unit variables are solved.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <iterator>
#include <tuple>

#include "chimera/base/hosted/wording.h"
#include "chimera/units/quantity.h"
#include "chimera/verify/converter.h"
#include "chimera/verify/rules/rules.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

using Numbers = std::vector<std::size_t>;  // of witnesses, ascending

/// `by`: the witnesses that settled it.
struct NamedUnit {
  Unit unit;
  std::string text;
  Numbers by;
};

/// A written value. It is the weakest witness of a unit: ports count before values, and many values before one.
struct Witness {
  std::optional<PortRef> port;  ///< a constant of a task; nullopt: the given value of `variable`
  std::size_t variable = 0;     ///< in Model::variables
  NamedUnit unit;               ///< as written
  bool is_heard = true;         ///< false: it is the odd one out, and settles nothing
};

/// The bindings, the witnesses, and all unit expressions of the ports, each parsed once.
struct UnitTable {
  const UnitSystem& system;
  Bindings<NamedUnit> bindings{};
  std::map<std::string, UnitExpression, std::less<>> expressions{};
  std::vector<Witness> witnesses{};

  const UnitExpression& expression(const std::string& unit) {
    const auto known = expressions.find(unit);
    if (known != expressions.end()) return known->second;
    const Result<UnitExpression> parsed = system.parse_expression(unit);
    return expressions.emplace(unit, parsed ? *parsed : UnitExpression{}).first->second;  // the library has parsed it
  }
  /// The unit with the words of its text.
  UnitExpression worded(const NamedUnit& named) {
    const UnitExpression& parsed = expression(named.text);
    if (same(parsed.rest, named.unit)) return parsed;
    return {.variables = {}, .rest = named.unit, .words = {UnitWord{named.text}}};
  }
};

void add(Numbers& to, const Numbers& more) {
  Numbers all;
  std::ranges::set_union(to, more, std::back_inserter(all));
  to = std::move(all);
}

SymbolKey key_of(const Model& model, UnitTable& table, const LinkedPort& port, char letter) {
  const std::size_t index = kUnitVariables.find(letter);
  return symbol_key(model.tasks[port.task], port, std::string(1, letter),
                    [&](const PortDescriptor& other, const std::string&) {
                      return other.type != CHIMERA_STRUCT && table.expression(other.unit).variables[index] != 0;
                    });
}

/// Structs carry their units in their fields (rule_types.cc).
bool has_unit(const LinkedPort& port) { return port.declared->type != CHIMERA_STRUCT; }

void settle_unit(Model& model, VariableModel& variable, PortRef ref) {
  variable.unit = model.port(ref).unit;
  variable.unit_text = model.port(ref).unit_text;
  variable.unit_by = model.port(ref).unit_by;
  variable.unit_from = ref;
}

void start_with_concrete(Model& model, UnitTable& table) {
  for_each_port(model, [&](PortRef, LinkedPort& port) {
    if (!has_unit(port)) return;
    const UnitExpression& expression = table.expression(port.declared->unit);
    if (!expression.is_concrete()) return;
    port.unit = expression.rest;
    port.unit_text = port.declared->unit;
  });
  for (VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) {
      if (!variable.unit && model.port(ref).unit) settle_unit(model, variable, ref);
    });
}

/// Puts the bindings into the expression of the port; sets its unit if no variable is left open. `by`: of the bindings.
UnitExpression substituted(const Model& model, UnitTable& table, LinkedPort& port, Numbers& by) {
  UnitExpression expression = table.expression(port.declared->unit);
  for (const char letter : kUnitVariables) {
    if (expression.variables[kUnitVariables.find(letter)] == 0) continue;
    const auto bound = table.bindings.find(key_of(model, table, port, letter));
    if (bound == table.bindings.end()) continue;
    const NamedUnit& value = bound->second.value;
    expression = substitute(expression, letter, table.worded(value));
    add(by, value.by);
    if (!expression.is_concrete()) continue;
    port.unit = expression.rest;
    port.unit_text = port.declared->unit.size() == 1 ? value.text : text(expression);
    port.unit_by = by;
  }
  return expression;
}

/// Solves the only open variable of the port by `known`, and sets the unit of the port.
void bind(const Model& model, UnitTable& table, PortRef ref, LinkedPort& port, NamedUnit known) {
  Numbers by;
  const UnitExpression open = substituted(model, table, port, by);
  if (port.unit) return;
  const auto solved = solve(open, table.worded(known));
  if (!solved) return;
  add(known.by, by);
  if (port.declared->unit.size() != 1) known.text = text(solved->unit);
  known.unit = solved->unit.rest;
  table.bindings.try_emplace(key_of(model, table, port, solved->variable), Binding<NamedUnit>{std::move(known), ref});
  substituted(model, table, port, by);
}

void spread(Model& model, UnitTable& table) {
  for (bool moved = true; moved;) {
    moved = false;
    for_each_port(model, [&](PortRef ref, LinkedPort& port) {
      if (port.unit || !has_unit(port)) return;
      VariableModel* variable = model.variable(port);
      Numbers by;
      if (variable != nullptr && variable->unit)
        bind(model, table, ref, port, {*variable->unit, variable->unit_text, variable->unit_by});
      else
        substituted(model, table, port, by);
      if (!port.unit) return;
      moved = true;
      if (variable != nullptr && !variable->unit) settle_unit(model, *variable, ref);
    });
  }
}

/// Calls `act` for each number of a written value; texts in quotes and truth values are none.
template <class Do>
void for_each_number(const Node& node, Do act) {
  for (const Node& item : node.items)
    if (node.is_list()) for_each_number(item, act);
  if (node.is_scalar() && !node.quoted && node.text != "true" && node.text != "false") act(node);
}

/// The unit that most numbers of a written value can be converted to.
std::optional<NamedUnit> unit_of(const Model& model, const Node& node) {
  std::vector<std::pair<NamedUnit, std::size_t>> found;
  for_each_number(node, [&](const Node& number) {
    const auto quantity = parse_quantity(number.text, model.library.units());
    if (!quantity) return;
    const auto like = std::ranges::find_if(
        found, [&](const auto& known) { return conversion(known.first.unit, quantity->unit).has_value(); });
    if (like != found.end()) ++like->second;
    else found.push_back({{quantity->unit, quantity->unit_text, {}}, 1});
  });
  if (found.empty()) return std::nullopt;
  return std::ranges::max_element(found, {}, [](const auto& known) { return known.second; })->first;
}

void add_witness(const Model& model, UnitTable& table, Witness witness, const Node& written) {
  auto unit = unit_of(model, written);
  if (!unit) return;
  unit->by = {table.witnesses.size()};
  witness.unit = *std::move(unit);
  table.witnesses.push_back(std::move(witness));
}

void find_witnesses(Model& model, UnitTable& table) {
  for (std::size_t v = 0; v < model.variables.size(); ++v)
    if (model.variables[v].is_written())
      add_witness(model, table, {.port = std::nullopt, .variable = v, .unit = {}}, model.variables[v].given->value);
  for_each_port(model, [&](PortRef ref, LinkedPort& port) {
    if (has_unit(port) && port.own != nullptr && port.is(CHIMERA_IN_CONST))
      add_witness(model, table, {.port = ref, .unit = {}}, *port.own);
  });
}

void take_from_values(Model& model, UnitTable& table) {
  for (const Witness& witness : table.witnesses) {
    if (witness.port || !witness.is_heard) continue;
    VariableModel& variable = model.variables[witness.variable];
    if (variable.unit) continue;
    variable.unit = witness.unit.unit;
    variable.unit_text = witness.unit.text;
    variable.unit_by = witness.unit.by;
    spread(model, table);  // before the next value: a known unit wins over a value
  }
  // A value settles one unknown: "X/U" waits until another value has settled one of its two.
  for (bool moved = true; moved;) {
    moved = false;
    for (const Witness& witness : table.witnesses) {
      if (!witness.port || !witness.is_heard || model.port(*witness.port).unit) continue;
      bind(model, table, *witness.port, model.port(*witness.port), witness.unit);
      spread(model, table);
      moved = moved || model.port(*witness.port).unit.has_value();
    }
  }
}

/// True if a repeated constant with a default, which may have no number here, has the unit of the repeated port.
bool has_default_beside(const Model& model, const LinkedPort& port) {
  return port.declared->repeated &&
         std::ranges::any_of(model.tasks[port.task].component->ports, [&](const PortDescriptor& declared) {
           return declared.repeated && declared.kind == CHIMERA_IN_CONST && !declared.initial.empty() &&
                  declared.unit == port.declared->unit;
         });
}

/// A default is a plain number: if no other source settles its unit, it has none.
void take_from_defaults(Model& model, UnitTable& table) {
  for_each_port(model, [&](PortRef ref, LinkedPort& port) {
    const bool has_default = port.source == ConstSource::kDefault || has_default_beside(model, port);
    if (port.unit || !has_unit(port) || !has_default) return;
    bind(model, table, ref, port, {Unit{}, "1", {}});
    if (VariableModel* variable = model.variable(port); variable != nullptr && port.unit && !variable->unit)
      settle_unit(model, *variable, ref);
    spread(model, table);
  });
}

void settle_units(Model& model, UnitTable& table) {
  table.bindings.clear();
  for_each_port(model, [](PortRef, LinkedPort& port) { port.unit.reset(), port.unit_by.clear(); });
  for (VariableModel& variable : model.variables) variable.unit.reset(), variable.unit_from.reset();
  start_with_concrete(model, table);
  spread(model, table);
  take_from_values(model, table);
  take_from_defaults(model, table);
}

/// True if the port cannot have the unit of its variable.
bool clashes(const LinkedPort& port, const VariableModel& variable) {
  return has_unit(port) && port.unit && variable.unit && !same(*port.unit, *variable.unit);
}

/// How well the units fit together.
struct Fit {
  std::size_t faults = 0;  ///< 2 for each link that clashes or port without a unit, 1 for each value that does not fit
  std::size_t worded = 0;  ///< values that do not fit and have a unit; a forgotten unit is the likelier mistake
  std::map<std::size_t, std::size_t> suspects{};  ///< witness -> faults that rest on it

  bool operator<(const Fit& other) const { return std::tie(faults, worded) < std::tie(other.faults, other.worded); }
};

Fit fit_of(Model& model, const UnitTable& table) {
  Fit fit;
  const auto blame = [&](std::size_t weight, Numbers by, const Numbers& more) {
    fit.faults += weight;
    add(by, more);
    for (const std::size_t number : by) ++fit.suspects[number];
  };
  for (const VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) {
      if (clashes(model.port(ref), variable)) blame(2, model.port(ref).unit_by, variable.unit_by);
    });
  for_each_port(model, [&](PortRef, const LinkedPort& port) { fit.faults += has_unit(port) && !port.unit ? 2 : 0; });
  for (const Witness& witness : table.witnesses) {
    const auto judge = [&](const auto& target) {
      if (!target.unit || conversion(witness.unit.unit, *target.unit)) return;
      blame(1, target.unit_by, {});
      fit.worded += witness.unit.text == "1" ? 0 : 1;
    };
    if (witness.port) judge(model.port(*witness.port));
    else judge(model.variables[witness.variable]);
  }
  return fit;
}

/// The suspects of most faults, most first; a bound for the time of a hostile description.
Numbers ranked(const std::map<std::size_t, std::size_t>& suspects) {
  constexpr std::size_t kMost = 32;
  Numbers all;
  for (const auto& [number, faults] : suspects) all.push_back(number);
  std::ranges::stable_sort(all, std::greater{}, [&](std::size_t number) { return suspects.at(number); });
  if (all.size() > kMost) all.resize(kMost);
  return all;
}

/// Finds values that the others outvote: without them as witnesses fewer faults remain. Such a value is then reported
/// alone, because it does not fit its port (rule_values.cc).
void outvote(Model& model, UnitTable& table) {
  for (Fit now = fit_of(model, table); !now.suspects.empty();) {
    Witness* odd = nullptr;
    Fit best = now;
    for (const std::size_t number : ranked(now.suspects)) {
      Witness& witness = table.witnesses[number];
      witness.is_heard = false;
      settle_units(model, table);
      if (const Fit without = fit_of(model, table); without < best) best = without, odd = &witness;
      witness.is_heard = true;
    }
    if (odd != nullptr) odd->is_heard = false;
    settle_units(model, table);
    if (odd == nullptr) return;
    now = best;
  }
}

std::string remedy(const Model& model, const LinkedPort& port, const VariableModel& variable) {
  const bool into = !port.is_producer();
  const WordedUnit mine{*port.unit, port.unit_text}, theirs{*variable.unit, variable.unit_text};
  const WordedUnit &from = into ? theirs : mine, &to = into ? mine : theirs;
  const auto factor = conversion(from.unit, to.unit);
  if (!factor) return "they measure different things: link it to another variable by alias";
  char law[80];
  std::snprintf(law, sizeof law, factor->offset == 0 ? "times %.10g" : "times %.10g plus %.10g", factor->factor,
                factor->offset);
  const std::string what = from.text + " to " + to.text + " (" + law + ")";
  const auto converter = converter_of(model.library, from, to);
  if (!converter) return "insert a component that converts " + what;
  const std::string with = converter->factor.empty() ? "" : " with constants: {factor: " + converter->factor + "}";
  return "insert the component '" + converter->component + "'" + with + ": " + what;
}

void report_contradiction(Model& model, UnitTable& table, const LinkedPort& port, const VariableModel& variable) {
  std::string by;
  for (const auto& [key, binding] : table.bindings)
    if (key.first == port.task && port.declared->unit.find(key.second[0]) != std::string::npos)
      append_joined(by, ", ", std::string(1, key.second[0]) + " is " + binding.value.text + " by '" +
                                  model.port(binding.from).name + "'");
  model.error("unit-contradiction", port,
              model.say(port) + " has unit '" + port.declared->unit + "', so " + port.unit_text + " because " + by +
                  "; " + settled_by(model, variable, variable.unit_from) + " is in " + variable.unit_text,
              variable.unit_text, port.unit_text, {}, remedy(model, port, variable));
}

void compare(Model& model, UnitTable& table, const VariableModel& variable, const LinkedPort& port) {
  if (!clashes(port, variable)) return;
  if (!table.expression(port.declared->unit).is_concrete()) {
    report_contradiction(model, table, port, variable);
    return;
  }
  model.error("unit-clash", port,
              model.say(port) + " is in " + port.unit_text + "; " + settled_by(model, variable, variable.unit_from) +
                  " is in " + variable.unit_text,
              port.unit_text, variable.unit_text, {}, remedy(model, port, variable));
}

/// A value whose unit cannot be read settles nothing: then it is the cause. Returns if there is one.
bool report_unread(Model& model, const LinkedPort& port, const Node& written, const std::string& what) {
  bool found = false;
  for_each_number(written, [&](const Node& number) {
    const auto quantity = parse_quantity(number.text, model.library.units());
    if (quantity || found) return;
    found = true;
    model.error("quantity-bad", Spot(number.at, port), what + ": " + std::string(quantity.error().message.view()),
                number.text, "a quantity");
  });
  return found;
}

bool report_unread_values(Model& model) {
  bool found = false;
  const auto is_open = [&](PortRef ref) { return has_unit(model.port(ref)) && !model.port(ref).unit; };
  for (const VariableModel& variable : model.variables) {
    const auto reader = std::ranges::find_if(variable.consumers, is_open);
    if (variable.given != nullptr && reader != variable.consumers.end())
      found |= report_unread(model, model.port(*reader), variable.given->value, value_name(variable));
  }
  for_each_port(model, [&](PortRef ref, const LinkedPort& port) {
    if (port.own != nullptr && port.is(CHIMERA_IN_CONST) && is_open(ref))
      found |= report_unread(model, port, *port.own, value_name(model, port));
  });
  return found;
}

void report_unsolved_unit(Model& model, const LinkedPort& port) {
  model.error("unit-unsolved", port, "nothing settles the unit '" + port.declared->unit + "' of " + model.say(port),
              port.declared->unit, "a linked port or a value of a known unit", {},
              "link one of its ports to a component with a fixed unit");
}

}  // namespace

void agree_on_units(Model& model) {
  UnitTable table{model.library.units()};
  find_witnesses(model, table);
  settle_units(model, table);
  outvote(model, table);
  for (const VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) { compare(model, table, variable, model.port(ref)); });
  if (model.is_incomplete() || model.has_unmet || report_unread_values(model)) return;  // it would settle the rest
  for_each_port(model, [&](PortRef, const LinkedPort& port) {
    if (!port.unit && has_unit(port)) report_unsolved_unit(model, port);
  });
}

}  // namespace chimera
