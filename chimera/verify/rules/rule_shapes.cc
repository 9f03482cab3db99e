// SPDX-License-Identifier: Apache-2.0
// Compares extents as symbols, and as numbers if the description settles them. init compares extents that cannot be
// proved unequal here.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "chimera/task/number_at.h"
#include "chimera/units/quantity.h"
#include "chimera/verify/rules/rules.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

using ExtentBindings = Bindings<std::vector<SolvedExtent>>;  // one extent, except for shape variables

/// The constant port of the component with the name of the extent, or nullptr: then it is an extent variable.
const PortDescriptor* giver(const TaskModel& task, const std::string& symbol) {
  const PortDescriptor* port = task.component->port(symbol);
  return port != nullptr && port->is_constant() ? port : nullptr;
}

bool uses_shape(const PortDescriptor& port, const std::string& symbol) {
  return std::any_of(port.extents.begin(), port.extents.end(), [&](const Extent& e) { return e.symbol == symbol; });
}

SymbolKey key_of(const TaskModel& task, const LinkedPort& port, const std::string& symbol) {
  return symbol_key(task, port, symbol, uses_shape);
}

/// A written or default number of elements; nullopt if it is none (check_values reports that).
std::optional<std::uint32_t> whole(double value) {
  if (!(value >= 1 && value <= kMaxExtent) || value != std::floor(value)) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

std::optional<std::uint32_t> count_of(const Model& model, const Node& node) {
  if (!node.is_scalar()) return std::nullopt;
  const auto quantity = parse_quantity(node.text, model.library.units());
  return quantity && quantity->unit.is_dimensionless() ? whole(quantity->value) : std::nullopt;
}

std::optional<std::uint32_t> default_of(const PortDescriptor& port) {
  return port.initial.empty() ? std::nullopt : whole(number_at(port.type, port.initial.data()));
}

/// The extent that a constant port of the task gives.
SolvedExtent by_constant(Model& model, const TaskModel& task, const PortDescriptor& constant, std::uint32_t max) {
  SolvedExtent out{.constant = {}, .max = max, .known = std::nullopt};
  for (const LinkedPort& port : task.ports) {
    if (port.declared != &constant) continue;
    if (port.source == ConstSource::kOwn) out.known = count_of(model, *port.own);
    if (port.source == ConstSource::kDefault) out.known = default_of(constant);
    if (port.is_linked()) {
      out.constant = port.variable;
      const VariableModel* variable = model.variable(port.variable);
      if (variable != nullptr && variable->given != nullptr) out.known = count_of(model, variable->given->value);
    }
  }
  return out;
}

bool is_too_large(Model& model, const LinkedPort& port, const std::string& symbol, const SolvedExtent& extent,
                  const std::string& why) {
  if (!extent.known || *extent.known <= extent.max) return false;
  model.error("shape-clash", port,
              model.say(port) + " holds at most " + std::to_string(extent.max) + " (shape " + port.declared->shape +
                  "), and '" + symbol + "' is " + std::to_string(*extent.known) + why,
              std::to_string(*extent.known), "at most " + std::to_string(extent.max), {},
              "use a component with a larger maximum, or a smaller '" + symbol + "'");
  return true;
}

/// Solves extents that need no neighbour. False while a variable is open.
bool try_shape(Model& model, LinkedPort& port, const ExtentBindings& bindings) {
  const TaskModel& task = model.tasks[port.task];
  std::vector<SolvedExtent> extents;
  for (const Extent& declared : port.declared->extents) {
    if (declared.is_literal()) {
      extents.push_back({.constant = {}, .max = declared.max, .known = declared.max});
      continue;
    }
    if (const PortDescriptor* constant = giver(task, declared.symbol)) {
      extents.push_back(by_constant(model, task, *constant, declared.max));
      SolvedExtent& extent = extents.back();
      const bool is_fixed = !is_too_large(model, port, declared.symbol, extent, "") && extent.constant.empty();
      if (is_fixed) extent.max = extent.known.value_or(extent.max);
      continue;
    }
    const auto bound = bindings.find(key_of(task, port, declared.symbol));
    if (bound == bindings.end()) return false;
    extents.insert(extents.end(), bound->second.value.begin(), bound->second.value.end());
  }
  port.extents = std::move(extents);
  port.has_extents = true;
  return true;
}

void settle_shape(Model& model, VariableModel& variable, PortRef ref) {
  variable.extents = model.port(ref).extents;
  variable.has_extents = true;
  variable.shape_from = ref;
}

/// A shape variable gets the dimensions of the variable unchanged.
void bind_shape(Model& model, PortRef ref, const LinkedPort& port, const VariableModel& variable,
                ExtentBindings& bindings) {
  const Extent& declared = port.declared->extents[0];
  const auto [bound, is_new] = bindings.try_emplace(key_of(model.tasks[port.task], port, declared.symbol),
                                                    Binding<std::vector<SolvedExtent>>{variable.extents, ref});
  if (!is_new) return;
  const std::uint32_t most = element_count(variable.extents);
  if (most <= declared.max) return;
  model.error("shape-clash", port,
              model.say(port) + " holds at most " + std::to_string(declared.max) + " elements (shape " +
                  port.declared->shape + "), and " + shape_text(variable.extents) + " by " +
                  settled_by(model, variable, variable.shape_from) + " may be " + std::to_string(most),
              std::to_string(most), "at most " + std::to_string(declared.max), {},
              "use a component with a larger maximum, or a smaller shape");
}

/// Binds the open extent variables of a port to the shape of its variable.
void bind_extents(Model& model, PortRef ref, const LinkedPort& port, const VariableModel& variable,
                  ExtentBindings& bindings) {
  const TaskModel& task = model.tasks[port.task];
  const std::vector<Extent>& declared = port.declared->extents;
  const std::vector<SolvedExtent> one{{.constant = {}, .max = 1, .known = 1}};  // a scalar is a vector of one element
  const std::vector<SolvedExtent>& theirs = variable.extents.empty() ? one : variable.extents;
  if (declared.size() == 1 && declared[0].is_shape && variable.extents.size() != 1)
    return bind_shape(model, ref, port, variable, bindings);
  if (declared.size() != theirs.size()) return;
  for (std::size_t i = 0; i < declared.size(); ++i) {
    if (declared[i].is_literal() || giver(task, declared[i].symbol) != nullptr) continue;
    SolvedExtent extent = theirs[i];
    const std::uint32_t most = std::min(extent.max, declared[i].max);
    extent.max = declared[i].max;
    const auto [bound, is_new] =
        bindings.try_emplace(key_of(task, port, declared[i].symbol), Binding<std::vector<SolvedExtent>>{{extent}, ref});
    if (!is_new) continue;
    is_too_large(model, port, declared[i].symbol, extent, " by " + settled_by(model, variable, variable.shape_from));
    bound->second.value[0].max = extent.known ? std::max(most, *extent.known) : most;
  }
}

void spread(Model& model, ExtentBindings& bindings) {
  for (bool moved = true; moved;) {
    moved = false;
    for_each_port(model, [&](PortRef ref, LinkedPort& port) {
      if (port.has_extents) return;
      VariableModel* variable = model.variable(port);
      if (!try_shape(model, port, bindings)) {
        if (variable == nullptr || !variable->has_extents) return;
        bind_extents(model, ref, port, *variable, bindings);
        if (!try_shape(model, port, bindings)) return;
      }
      moved = true;
      if (variable != nullptr && !variable->has_extents) settle_shape(model, *variable, ref);
    });
  }
}

void take_from_values(Model& model, ExtentBindings& bindings) {
  const auto shape_of = [](const Node& node) {
    std::vector<SolvedExtent> extents;
    for (const Node* at = &node; at->is_list() && !at->items.empty() && extents.size() < CHIMERA_MAX_EXTENTS;
         at = &at->items[0]) {
      const auto count = static_cast<std::uint32_t>(at->items.size());
      extents.push_back({.constant = {}, .max = count, .known = count});
    }
    return extents;
  };
  for (VariableModel& variable : model.variables) {
    if (variable.has_extents || !variable.is_written()) continue;
    variable.extents = shape_of(variable.given->value);
    variable.has_extents = true;
    spread(model, bindings);
  }
  // A single value fills any extent. So it settles an extent only if no list does, here or at a neighbour.
  for (const bool is_list : {true, false})
    for_each_port(model, [&](PortRef ref, LinkedPort& port) {
      if (port.has_extents || port.own == nullptr || !port.is(CHIMERA_IN_CONST)) return;
      VariableModel written;
      written.extents = shape_of(*port.own);
      if (written.extents.empty() == is_list) return;
      written.shape_from = ref;
      bind_extents(model, ref, port, written, bindings);
      spread(model, bindings);
    });
}

/// True if two extents provably differ.
bool differ(const SolvedExtent& a, const SolvedExtent& b) {
  if (a.known && b.known) return *a.known != *b.known;
  return (a.known && *a.known > b.max) || (b.known && *b.known > a.max);
}

bool shapes_differ(const std::vector<SolvedExtent>& a, const std::vector<SolvedExtent>& b) {
  const auto is_one = [](const SolvedExtent& e) { return e.known && *e.known == 1; };
  if (a.size() != b.size()) return !std::all_of(a.begin(), a.end(), is_one) || !std::all_of(b.begin(), b.end(), is_one);
  for (std::size_t i = 0; i < a.size(); ++i)
    if (differ(a[i], b[i])) return true;
  return false;
}

std::string said(const std::vector<SolvedExtent>& extents) {
  std::string out = shape_text(extents);
  for (const SolvedExtent& extent : extents)
    if (!extent.constant.empty() && extent.known)
      out += " with " + extent.constant + " = " + std::to_string(*extent.known);
  return out.empty() ? "a scalar" : out;
}

void compare(Model& model, const VariableModel& variable, const LinkedPort& port, const ExtentBindings& bindings) {
  if (!variable.has_extents || !variable.shape_from) return;
  const std::string other = settled_by(model, variable, variable.shape_from);
  if (!port.has_extents) {  // a generic port with another number of dimensions
    if (port.declared->extents.size() == std::max<std::size_t>(variable.extents.size(), 1)) return;
    model.error("shape-clash", port,
                model.say(port) + " is " + port.declared->shape + "; " + other + " is " + said(variable.extents),
                port.declared->shape, said(variable.extents), {}, "link it to another variable by alias");
    return;
  }
  if (!shapes_differ(port.extents, variable.extents)) return;
  for (const Extent& extent : port.declared->extents) {
    const auto bound = bindings.find(key_of(model.tasks[port.task], port, extent.symbol));
    if (extent.is_literal() || bound == bindings.end()) continue;
    model.error("extent-contradiction", port,
                "extent variable '" + extent.symbol + "' of task '" + model.tasks[port.task].name() + "' gives " +
                    said(port.extents) + " by '" + model.port(bound->second.from).name + "'; " + model.say(port) +
                    " has " + said(variable.extents) + " (" + other + ")",
                said(variable.extents), said(port.extents), {}, "link both to variables of one shape");
    return;
  }
  model.error("shape-clash", port,
              model.say(port) + " is " + said(port.extents) + "; " + other + " is " + said(variable.extents),
              said(port.extents), said(variable.extents), {}, "link it to another variable by alias");
}

void report_unsolved_shape(Model& model, const LinkedPort& port) {
  const VariableModel* variable = model.variable(port);
  if (variable != nullptr && variable->has_extents && variable->shape_from) return;  // compare() reported it
  model.error("extent-unsolved", port,
              "nothing settles the shape " + port.declared->shape + " of " + model.say(port), port.declared->shape,
              "a linked port or a value of a known shape", {},
              "link one of its ports to a component with a fixed shape");
}

}  // namespace

void agree_on_shapes(Model& model) {
  ExtentBindings bindings;
  for_each_port(model, [&](PortRef, LinkedPort& port) { try_shape(model, port, bindings); });
  for (VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) {
      if (!variable.has_extents && model.port(ref).has_extents) settle_shape(model, variable, ref);
    });
  spread(model, bindings);
  take_from_values(model, bindings);
  spread(model, bindings);
  for (const VariableModel& variable : model.variables)
    for_each_port_of(variable, [&](PortRef ref) { compare(model, variable, model.port(ref), bindings); });
  if (!model.is_incomplete() && !model.has_unmet)  // the missing part would settle it
    for_each_port(model, [&](PortRef, const LinkedPort& port) {
      if (!port.has_extents) report_unsolved_shape(model, port);
    });
}

}  // namespace chimera
