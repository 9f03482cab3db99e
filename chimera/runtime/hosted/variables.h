// SPDX-License-Identifier: Apache-2.0
// Whether a set of ON tasks is legal, over the links that verification resolved: the set equations of set_equations.h
// for every state variable, and the smallest legal set that mends one that is not.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/set_equations.h"

namespace chimera {

/// "servo hold": the tasks t with on[t], in the order of the spec. Context: setup.
std::string names_in(const std::vector<bool>& on, std::span<const TaskSpec> tasks);

/// A view of spec.variables, which outlive it. Context: setup; the checks also at a cycle boundary.
class Variables {
 public:
  explicit Variables(const ApplicationSpec& spec) noexcept : variables_(spec.variables) {}

  std::span<const Variable> all() const noexcept { return variables_; }
  /// Index in all() of a name that a person wrote, or all().size(). O(variables).
  std::size_t find(std::string_view name) const noexcept;

  /// True when every in-var of a task of `on` has exactly one producer in it (or the operator) and no variable has
  /// two. `on[t]` says whether task t is in the set. O(ports); allocates nothing.
  bool is_legal(const std::vector<bool>& on) const noexcept;
  /// Says what is illegal and names the smallest legal set that holds `on`, where there is one. Empty when `on` is
  /// legal.
  std::string explain(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const;
  /// The first half of explain(): what is illegal. Empty when `on` is legal.
  std::string fault(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const;
  /// The smallest legal set that holds `on`; empty: none was found.
  std::vector<bool> smallest_legal(std::vector<bool> on) const;
  /// The second half of explain(): "the smallest legal set is: servo hold"; "" for an empty set.
  static std::string remedy(const std::vector<bool>& smallest, std::span<const TaskSpec> tasks);

 private:
  void complete(std::vector<bool>& on, std::vector<bool>& best, int& tries) const;

  std::span<const Variable> variables_;
};

}  // namespace chimera
