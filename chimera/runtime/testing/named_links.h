// SPDX-License-Identifier: Apache-2.0
// For tests: links by name for an application that is put together by hand, as verification resolves them for a
// description.
#pragma once

#include <string_view>
#include <vector>

#include "chimera/runtime/hosted/links.h"
#include "chimera/runtime/hosted/task_orders.h"

namespace chimera {

/// Owns what finish() makes a spec point at. Names outlive it.
class NamedLinks {
 public:
  /// The id of that name; the next one for a new name.
  VariableId variable(std::string_view name) { return VariableId(index_of(variables_, name)); }
  ConstantId constant(std::string_view name) { return ConstantId(index_of(constants_, name)); }
  /// Links a port as its kind says; "" leaves it without a link.
  void link(PortSpec& port, std::string_view name) {
    const bool is_variable = port.kind == CHIMERA_IN_VAR || port.kind == CHIMERA_OUT_VAR;
    const bool is_constant = port.kind == CHIMERA_IN_CONST || port.kind == CHIMERA_OUT_CONST;
    port.variable = is_variable && !name.empty() ? variable(name) : VariableId{};
    port.constant = is_constant && !name.empty() ? constant(name) : ConstantId{};
  }
  /// Adds the links and the orders to a spec that has its tasks, operators and start set.
  void finish(ApplicationSpec& spec) {
    for (std::size_t t = spec.tasks.size(); t-- > 0;)
      for (const PortSpec& port : spec.tasks[t].ports)
        if (port.constant.is_valid()) {
          constants_[port.constant.index].type = port.type;
          constants_[port.constant.index].element_bytes = port.element_bytes;
        }
    links_.fill(spec.tasks, spec.operators, variables_, constants_);
    spec.variables = variables_;
    spec.constants = constants_;
    on_order_ = make_on_order(spec);
    spec.on_order = on_order_;
    end_order_ = make_end_order(spec);
    spec.end_order = end_order_;
  }

 private:
  template <class Named>
  static std::size_t index_of(std::vector<Named>& all, std::string_view name) {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].name == name) return i;
    all.emplace_back().name = name;
    return all.size() - 1;
  }

  std::vector<Variable> variables_;
  std::vector<ConstantSpec> constants_;
  Links links_;
  std::vector<TaskId> on_order_, end_order_;
};

}  // namespace chimera
