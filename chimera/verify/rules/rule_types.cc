// SPDX-License-Identifier: Apache-2.0
// Rules on types: linked ports agree, and the type variables of generic ports are solved.
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

using TypeBindings = Bindings<std::uint32_t>;

bool uses_type(const PortDescriptor& port, const std::string& symbol) {
  return port.type == CHIMERA_ANY && port.type_name == symbol;
}

SymbolKey key_of(const Model& model, const LinkedPort& port) {
  return symbol_key(model.tasks[port.task], port, port.declared->type_name, uses_type);
}

bool is_scalar(std::uint32_t type) { return type <= CHIMERA_FLOAT64; }

/// The type for a type variable if only a written value decides.
std::optional<std::uint32_t> type_of(const Node& node) {
  if (node.is_list()) return node.items.empty() ? std::nullopt : type_of(node.items[0]);
  if (!node.is_scalar() || node.quoted) return std::nullopt;
  return node.text == "true" || node.text == "false" ? CHIMERA_BOOL : CHIMERA_FLOAT64;
}

std::string text_of(const Model& model, const VariableModel& variable) {
  return variable.type_from ? type_text(model.port(*variable.type_from)) : std::string(type_name(*variable.type));
}

void settle_type(Model& model, VariableModel& variable, PortRef ref) {
  variable.type = model.port(ref).type;
  variable.type_from = ref;
}

void start_with_concrete(Model& model) {
  for_each_port(model, [](PortRef, LinkedPort& port) {
    if (port.declared->type == CHIMERA_ANY) return;
    port.type = port.declared->type;
    port.element_bytes = port.declared->element_size;
  });
  for (VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) {
      if (!variable.type && model.port(ref).type) settle_type(model, variable, ref);
    });
}

/// Carries known types through generic ports until nothing changes. Each round settles at least one port.
void spread(Model& model, TypeBindings& bindings) {
  for (bool moved = true; moved;) {
    moved = false;
    for_each_port(model, [&](PortRef ref, LinkedPort& port) {
      if (port.type) return;
      VariableModel* variable = model.variable(port);
      const SymbolKey key = key_of(model, port);
      if (variable != nullptr && variable->type && is_scalar(*variable->type))
        bindings.try_emplace(key, Binding<std::uint32_t>{*variable->type, ref});
      const auto bound = bindings.find(key);
      if (bound == bindings.end()) return;
      port.type = bound->second.value;
      port.element_bytes = type_size(*port.type);
      moved = true;
      if (variable != nullptr && !variable->type) settle_type(model, *variable, ref);
    });
  }
}

/// If no port gives a type, a written value does.
void take_from_values(Model& model, TypeBindings& bindings) {
  for (VariableModel& variable : model.variables) {
    if (variable.type || !variable.is_written()) continue;
    variable.type = type_of(variable.given->value);
    spread(model, bindings);  // before the next value: a known type wins over a value
  }
  for_each_port(model, [&](PortRef ref, LinkedPort& port) {
    if (port.type || port.own == nullptr || !port.is(CHIMERA_IN_CONST)) return;
    if (const auto type = type_of(*port.own))
      bindings.try_emplace(key_of(model, port), Binding<std::uint32_t>{*type, ref});
  });
}

/// The first difference between two structs of one name, or "".
std::string difference(const Model& model, const PortDescriptor& a, const PortDescriptor& b) {
  const UnitSystem& units = model.library.units();
  if (a.fields.size() != b.fields.size())
    return std::to_string(a.fields.size()) + " fields and " + std::to_string(b.fields.size());
  for (std::size_t i = 0; i < a.fields.size(); ++i) {
    const FieldDescriptor &x = a.fields[i], &y = b.fields[i];
    if (x.name != y.name) return "field " + std::to_string(i + 1) + " is '" + x.name + "' and '" + y.name + "'";
    if (x.type != y.type || x.count != y.count || x.size != y.size || x.offset != y.offset)
      return "field '" + x.name + "' differs in type";
    const auto ux = units.parse(x.unit), uy = units.parse(y.unit);
    if (ux && uy && !same(*ux, *uy)) return "field '" + x.name + "' is in '" + x.unit + "' and in '" + y.unit + "'";
  }
  return {};
}

void report_clash(Model& model, const VariableModel& variable, const LinkedPort& port, const TypeBindings& bindings) {
  const std::string mine = type_text(port), theirs = text_of(model, variable);
  const std::string other = settled_by(model, variable, variable.type_from);
  if (port.declared->type == CHIMERA_ANY) {
    const LinkedPort& first = model.port(bindings.at(key_of(model, port)).from);
    model.error("type-contradiction", port,
                "type variable '" + port.declared->type_name + "' of task '" + model.tasks[port.task].name() + "' is " +
                    mine + " by '" + first.name + "' and " + theirs + " by '" + port.name + "' (" + other + ")",
                theirs, mine, {}, "link both to variables of one type");
    return;
  }
  model.error("type-clash", port, model.say(port) + " is " + mine + "; " + other + " is " + theirs, mine, theirs, {},
              "link it to another variable by alias, or insert a component that converts " + theirs + " to " + mine);
}

/// Reports a port whose type is not that of its variable. Returns if there was a fault.
bool compare(Model& model, const VariableModel& variable, PortRef ref, const TypeBindings& bindings) {
  const LinkedPort& port = model.port(ref);
  if (!port.type || !variable.type || variable.type_from == std::nullopt) return false;
  const LinkedPort& first = model.port(*variable.type_from);
  const bool same_size = port.element_bytes == first.element_bytes;
  if (*port.type != *variable.type || (*port.type == CHIMERA_STRING && !same_size) ||
      (*port.type == CHIMERA_STRUCT && port.declared->type_name != first.declared->type_name)) {
    report_clash(model, variable, port, bindings);
    return true;
  }
  if (*port.type != CHIMERA_STRUCT) return false;
  const std::string differs = difference(model, *port.declared, *first.declared);
  if (differs.empty()) return false;
  model.error("struct-clash", port,
              model.say(port) + " and " + settled_by(model, variable, variable.type_from) +
                  " mean different structs '" + port.declared->type_name + "': " + differs,
              port.declared->type_name, {}, {}, "build both components against one definition of the struct");
  return true;
}

bool is_refused(const VariableModel* variable) {
  return variable != nullptr && variable->type && !is_scalar(*variable->type);
}

/// True if another port of the same type variable is linked to a variable that it cannot accept.
bool follows_from_another(Model& model, const LinkedPort& port) {
  for (const LinkedPort& other : model.tasks[port.task].ports)
    if (&other != &port && uses_type(*other.declared, port.declared->type_name) && is_refused(model.variable(other)))
      return true;
  return false;
}

void report_unsolved_type(Model& model, const LinkedPort& port) {
  const VariableModel* variable = model.variable(port);
  if (is_refused(variable)) {
    model.error("type-clash", port,
                model.say(port) + " takes any number; " + settled_by(model, *variable, variable->type_from) + " is " +
                    text_of(model, *variable),
                text_of(model, *variable), "a number", {}, "link it to another variable by alias");
    return;
  }
  if (follows_from_another(model, port)) return;
  model.error("type-unsolved", port,
              "nothing settles the type '" + port.declared->type_name + "' of " + model.say(port),
              port.declared->type_name, "a linked port or a value of a known type", {},
              "link one of its ports to a component with a fixed type");
}

}  // namespace

void agree_on_types(Model& model) {
  TypeBindings bindings;
  start_with_concrete(model);
  spread(model, bindings);
  take_from_values(model, bindings);
  spread(model, bindings);
  const bool may_miss_a_part = model.is_incomplete() || model.has_unmet;  // which would settle the rest
  std::vector<PortRef> wrong;
  for (const VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) {
      if (compare(model, variable, ref, bindings) && !model.port(ref).is_producer()) wrong.push_back(ref);
    });
  for (const PortRef ref : wrong) model.unlink(ref);
  if (may_miss_a_part) return;
  for_each_port(model, [&](PortRef, const LinkedPort& port) {
    if (!port.type) report_unsolved_type(model, port);
  });
}

}  // namespace chimera
