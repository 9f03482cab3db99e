// SPDX-License-Identifier: Apache-2.0
// Rules on units: linked ports can be converted into each other, and unit variables are solved.
#include <algorithm>
#include <cstdio>

#include "chimera/base/hosted/wording.h"
#include "chimera/units/quantity.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

struct NamedUnit {
  Unit unit;
  std::string text;
};

/// The bindings, and all unit expressions of the ports, each parsed once.
struct UnitTable {
  Bindings<NamedUnit> bindings;
  std::map<std::string, UnitExpression, std::less<>> expressions;
  const UnitSystem& system;

  const UnitExpression& expression(const std::string& unit) {
    const auto known = expressions.find(unit);
    if (known != expressions.end()) return known->second;
    const Result<UnitExpression> parsed = system.parse_expression(unit);
    return expressions.emplace(unit, parsed ? *parsed : UnitExpression{}).first->second;  // the library has parsed it
  }
};

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

/// The unit in the form that a person would write: the declared text with the variable replaced, if it stays one word.
std::string written_unit(const std::string& declared, char letter, const NamedUnit& solved, const Unit& unit) {
  if (declared.size() == 1) return solved.text;
  const bool one_word = solved.text.find_first_of("./^ 0123456789") == std::string::npos;
  const std::size_t at = declared.find(letter);
  if (!one_word || declared.find(letter, at + 1) != std::string::npos) return text(unit);
  return std::string(declared).replace(at, 1, solved.text);
}

/// Puts the bindings into the expression of the port; sets its unit if no variable is left open.
UnitExpression substituted(const Model& model, UnitTable& table, LinkedPort& port) {
  UnitExpression expression = table.expression(port.declared->unit);
  const bool single = expression.unknowns() == 1;
  for (const char letter : kUnitVariables) {
    if (expression.variables[kUnitVariables.find(letter)] == 0) continue;
    const auto bound = table.bindings.find(key_of(model, table, port, letter));
    if (bound == table.bindings.end()) continue;
    expression = substitute(expression, letter, bound->second.value.unit);
    if (expression.is_concrete()) {
      port.unit = expression.rest;
      port.unit_text = single ? written_unit(port.declared->unit, letter, bound->second.value, expression.rest)
                              : text(expression.rest);
    }
  }
  return expression;
}

bool bind(const Model& model, UnitTable& table, PortRef ref, const LinkedPort& port, const UnitExpression& open,
          const NamedUnit& known) {
  const auto solved = solve(open, known.unit);
  if (!solved) return false;
  const bool alone = port.declared->unit.size() == 1;
  table.bindings.try_emplace(key_of(model, table, port, solved->variable),
                             Binding<NamedUnit>{{solved->unit, alone ? known.text : text(solved->unit)}, ref});
  return true;
}

void spread(Model& model, UnitTable& table) {
  for (bool moved = true; moved;) {
    moved = false;
    for_each_port(model, [&](PortRef ref, LinkedPort& port) {
      if (port.unit || !has_unit(port)) return;
      VariableModel* variable = model.variable(port);
      UnitExpression open = substituted(model, table, port);
      if (!port.unit && variable != nullptr && variable->unit &&
          bind(model, table, ref, port, open, {*variable->unit, variable->unit_text}))
        substituted(model, table, port);
      if (!port.unit) return;
      moved = true;
      if (variable != nullptr && !variable->unit) settle_unit(model, *variable, ref);
    });
  }
}

/// The unit of the first number of a written value.
std::optional<NamedUnit> unit_of(const Model& model, const Node& node) {
  if (node.is_list() && !node.items.empty()) return unit_of(model, node.items[0]);
  if (!node.is_scalar() || node.quoted) return std::nullopt;
  const auto quantity = parse_quantity(node.text, model.library.units());
  if (!quantity) return std::nullopt;
  return NamedUnit{quantity->unit, quantity->unit_text};
}

void take_from_values(Model& model, UnitTable& table) {
  for (VariableModel& variable : model.variables) {
    if (variable.unit || variable.given == nullptr) continue;
    if (const auto unit = unit_of(model, variable.given->value)) {
      variable.unit = unit->unit;
      variable.unit_text = unit->text;
      spread(model, table);  // before the next value: a known unit wins over a value
    }
  }
  // A value settles one unknown: "X/U" waits until another value has settled one of its two.
  for (bool moved = true; moved;) {
    moved = false;
    for_each_port(model, [&](PortRef ref, LinkedPort& port) {
      if (port.unit || !has_unit(port) || port.own == nullptr || !port.is(CHIMERA_IN_CONST)) return;
      if (const auto unit = unit_of(model, *port.own))
        bind(model, table, ref, port, substituted(model, table, port), *unit);
      spread(model, table);
      moved = moved || port.unit.has_value();
    });
  }
}

/// A default is a plain number: if no other source settles its unit, it has none.
void take_from_defaults(Model& model, UnitTable& table) {
  for_each_port(model, [&](PortRef ref, LinkedPort& port) {
    if (port.unit || !has_unit(port) || port.source != ConstSource::kDefault) return;
    bind(model, table, ref, port, substituted(model, table, port), {Unit{}, "1"});
    spread(model, table);
  });
}

/// A component of the library of the framework: y = factor x, for any two units of one dimension.
constexpr const char* kAnyConverter = "unit_convert";

/// The component of the library that converts `from` to `to`, or "".
std::string converter(const Model& model, UnitTable& table, const Unit& from, const Unit& to) {
  for (const LibraryEntry& entry : model.library.entries()) {
    std::size_t fits = 0, others = 0;
    for (const PortDescriptor& port : entry.descriptor.ports) {
      if (port.type == CHIMERA_STRUCT || port.is_constant()) continue;
      const UnitExpression& expression = table.expression(port.unit);
      const Unit& wanted = port.kind == CHIMERA_IN_VAR ? from : to;
      const bool is_var = port.kind == CHIMERA_IN_VAR || port.kind == CHIMERA_OUT_VAR;
      const bool fit = is_var && expression.is_concrete() && same(expression.rest, wanted);
      ++(fit ? fits : others);
    }
    if (fits == 2 && others == 0) return entry.descriptor.name;
  }
  return {};
}

std::string remedy(const Model& model, UnitTable& table, const LinkedPort& port, const VariableModel& variable) {
  const bool into = !port.is_producer();
  const NamedUnit mine{*port.unit, port.unit_text}, theirs{*variable.unit, variable.unit_text};
  const NamedUnit &from = into ? theirs : mine, &to = into ? mine : theirs;
  const auto factor = conversion(from.unit, to.unit);
  if (!factor) return "they measure different things: link it to another variable by alias";
  const std::string name = converter(model, table, from.unit, to.unit);
  char law[80];
  std::snprintf(law, sizeof law, factor->offset == 0 ? "times %.10g" : "times %.10g plus %.10g", factor->factor,
                factor->offset);
  const std::string what = from.text + " to " + to.text + " (" + law + ")";
  if (!name.empty()) return "insert the component '" + name + "': " + what;
  const auto is_general = [](const LibraryEntry& entry) { return entry.descriptor.name == kAnyConverter; };
  const auto& entries = model.library.entries();
  if (factor->offset != 0 || std::none_of(entries.begin(), entries.end(), is_general))
    return "insert a component that converts " + what;
  const auto part = [](const std::string& unit) {
    return unit.find_first_of(" .*/^()0123456789") == std::string::npos ? unit : "(" + unit + ")";
  };
  std::snprintf(law, sizeof law, "%.10g ", factor->factor);
  return std::string("insert the component '") + kAnyConverter + "' with constants: {factor: " + law + part(to.text) +
         "/" + part(from.text) + "}: " + what;
}

void report_contradiction(Model& model, UnitTable& table, const LinkedPort& port, const VariableModel& variable) {
  std::string by;
  for (const auto& [key, binding] : table.bindings)
    if (key.first == port.task && port.declared->unit.find(key.second[0]) != std::string::npos)
      append_joined(by, ", ", std::string(1, key.second[0]) + " is " + binding.value.text + " by '" +
                                  model.port(binding.from).name + "'");
  model.error("unit-contradiction", port.at,
              model.say(port) + " has unit '" + port.declared->unit + "', so " + port.unit_text + " because " + by +
                  "; " + settled_by(model, variable, variable.unit_from) + " is in " + variable.unit_text,
              variable.unit_text, port.unit_text, {}, remedy(model, table, port, variable));
}

void compare(Model& model, UnitTable& table, const VariableModel& variable, const LinkedPort& port) {
  if (!has_unit(port) || !variable.unit) return;
  const UnitExpression& declared = table.expression(port.declared->unit);
  if (!port.unit || same(*port.unit, *variable.unit)) return;
  if (!declared.is_concrete()) {
    report_contradiction(model, table, port, variable);
    return;
  }
  model.error("unit-clash", port.at,
              model.say(port) + " is in " + port.unit_text + "; " + settled_by(model, variable, variable.unit_from) +
                  " is in " + variable.unit_text,
              port.unit_text, variable.unit_text, {}, remedy(model, table, port, variable));
}

void report_unsolved_unit(Model& model, const LinkedPort& port) {
  model.error("unit-unsolved", port.at, "nothing settles the unit '" + port.declared->unit + "' of " + model.say(port),
              port.declared->unit, "a linked port or a value of a known unit", {},
              "link one of its ports to a component with a fixed unit");
}

}  // namespace

void agree_on_units(Model& model) {
  UnitTable table{{}, {}, model.library.units()};
  start_with_concrete(model, table);
  spread(model, table);
  take_from_values(model, table);
  spread(model, table);
  take_from_defaults(model, table);
  for (const VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) { compare(model, table, variable, model.port(ref)); });
  if (model.is_incomplete() || model.has_unmet) return;  // the missing part would settle it
  for_each_port(model, [&](PortRef, const LinkedPort& port) {
    if (!port.unit && has_unit(port)) report_unsolved_unit(model, port);
  });
}

}  // namespace chimera
