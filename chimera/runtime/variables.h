// SPDX-License-Identifier: Apache-2.0
// Who produces and who consumes each state variable of a context, and whether a set of ON tasks is legal:
// the two set equations of the 1994 paper, section 3.2, over the tasks that are (or would be) ON.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Output or input number `index` of a task, in the order of its ports of that kind.
struct PortOf {
  TaskId task;
  std::uint32_t index = 0;
};

struct Variable {
  std::string_view name;
  std::vector<PortOf> producers;
  std::vector<PortOf> consumers;
  std::uint32_t operator_index = UINT32_MAX;  ///< in ApplicationSpec::operators; UINT32_MAX: not an operator's
};

/// Immutable. Context: setup; the checks also at an edge.
class Variables {
 public:
  explicit Variables(const ApplicationSpec& spec);

  std::span<const Variable> all() const noexcept { return variables_; }
  /// Index in all(), or all().size().
  std::size_t find(std::string_view name) const noexcept;
  /// The variable behind input / output `index` of a task.
  VariableId input(TaskId task, std::uint32_t index) const noexcept { return inputs_[task.index][index]; }
  VariableId output(TaskId task, std::uint32_t index) const noexcept { return outputs_[task.index][index]; }

  /// True when every in-var of a task of `on` has exactly one producer in it (or the operator) and no variable has
  /// two. `on[t]` says whether task t is in the set. O(ports); allocates nothing.
  bool is_legal(const std::vector<bool>& on) const noexcept;
  /// Says what is illegal and names the smallest legal set that holds `on`, where there is one. Empty when `on` is
  /// legal.
  std::string explain(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const;
  /// The two halves of explain(): what is illegal, and "the smallest legal set is: servo hold". Each may be empty.
  std::string fault(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const;
  std::string remedy(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const;

 private:
  std::size_t index_of(std::string_view name);
  std::size_t writers(const Variable& variable, const std::vector<bool>& on) const noexcept;
  bool is_read(const Variable& variable, const std::vector<bool>& on) const noexcept;
  std::string smallest_legal(std::vector<bool> on, std::span<const TaskSpec> tasks) const;
  void complete(std::vector<bool>& on, std::vector<bool>& best, int& tries) const;

  std::vector<Variable> variables_;
  std::vector<std::vector<VariableId>> inputs_;
  std::vector<std::vector<VariableId>> outputs_;
};

}  // namespace chimera
