// SPDX-License-Identifier: Apache-2.0
// Checks a declared order between two constants of a component: the lower one is never above the other.
#include <algorithm>
#include <charconv>

#include "chimera/base/hosted/wording.h"
#include "chimera/task/number_at.h"
#include "chimera/verify/rules/rules.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

const LinkedPort* port_named(const TaskModel& task, const std::string& name) {
  const auto found = std::ranges::find_if(task.ports, [&](const LinkedPort& p) { return p.declared->name == name; });
  return found == task.ports.end() ? nullptr : &*found;
}

/// The node with the written value, or nullptr: it is a default of the component.
const Node* written(Model& model, const LinkedPort& port) {
  if (port.own != nullptr) return port.own;
  const VariableModel* variable = model.variable(port);
  return variable != nullptr && variable->given != nullptr ? &variable->given->value : nullptr;
}

/// The number of elements that the value has for certain: from the shape, otherwise from the list. A single value fills
/// any number.
std::size_t certain(Model& model, const LinkedPort& port) {
  const bool is_settled = std::ranges::all_of(port.extents, [](const SolvedExtent& e) { return e.known == e.max; });
  if (is_settled) return element_count(port.extents);
  const Node* node = written(model, port);
  if (node == nullptr || !node->is_list()) return element_count(port.extents);
  return port.extents.size() == 1 ? node->items.size() : 0;  // the padding of the rows of a matrix is not settled
}

std::string number_text(const LinkedPort& port, double value) {
  char out[32];
  const std::string number(out, std::to_chars(out, out + sizeof out, value).ptr);
  return with_unit(number, port.unit_text);
}

void refuse(Model& model, const LinkedPort& lower, const LinkedPort& upper, std::size_t element, double low,
            double high) {
  const Node* node = written(model, upper);
  if (node == nullptr) node = written(model, lower);
  const std::string task = model.tasks[upper.task].name();
  const std::string place = element_count(upper.extents) == 1 ? "" : "[" + std::to_string(element) + "]";
  const std::string found = number_text(upper, high), least = number_text(lower, low);
  model.error("constant-order", Spot(node != nullptr ? node->at : upper.at, upper),
              "constant '" + upper.declared->name + place + "' of task '" + task + "' is " + found + ", below '" +
                  lower.declared->name + place + "'; expected at least " + least,
              found, "at least " + least, {},
              "let '" + lower.declared->name + "' be at most '" + upper.declared->name + "'");
}

}  // namespace

void check_order_of_constants(Model& model) {
  for (const TaskModel& task : model.tasks) {
    for (const LinkedPort& upper : task.ports) {
      if (upper.declared->at_least.empty() || upper.value.empty()) continue;
      const LinkedPort* lower = port_named(task, upper.declared->at_least);
      if (lower == nullptr || lower->value.empty()) continue;
      const std::size_t count = std::min(certain(model, *lower), certain(model, upper));
      for (std::size_t i = 0; i < count; ++i) {
        const double low = number_at(*lower->type, lower->value.data() + i * lower->element_bytes);
        const double high = number_at(*upper.type, upper.value.data() + i * upper.element_bytes);
        if (low <= high) continue;
        refuse(model, *lower, upper, i, low, high);
        break;
      }
    }
  }
}

}  // namespace chimera
