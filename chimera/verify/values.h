// SPDX-License-Identifier: Apache-2.0
// Converts written values to the bytes of a port: to its unit and its shape, checked against its range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chimera/verify/model.h"

namespace chimera {

/// The target of a value: a solved port.
struct ValueTarget {
  const LinkedPort& port;
  std::string what;      ///< for messages: "constant 'scale' of task 'left'"
  bool is_step = false;  ///< the largest step of a value: above 0; the declared range does not count
  const SetModel* set = nullptr;  ///< the configuration whose condition has the value; nullptr: the port has it
  bool is_quiet = false;  ///< another rule reports the faults
};

/// The bytes of `node` for the target: elements at their maxima, zero beyond the written ones. A value that is not a
/// list fills all elements. nullopt, after adding all faults, if it does not fit. Requires: type, unit and shape of the
/// port are solved. Context: setup.
std::optional<std::vector<std::byte>> value_bytes(Model& model, const Node& node, const ValueTarget& target);

/// "constant 'scale' of task 'left'": the value that the task writes for the port. Context: setup.
std::string value_name(const Model& model, const LinkedPort& port);
/// "operator variable 'kp'": the given value of the variable. Context: setup.
std::string value_name(const VariableModel& variable);

/// A declared initial value or default, broadcast to the port's solved shape. Context: setup.
std::vector<std::byte> declared_bytes(const LinkedPort& port);

/// True if type, unit and shape of the port are all known. Context: setup.
bool is_solved(const LinkedPort& port);

/// Elements at the maxima. Context: setup.
std::uint32_t element_count(std::span<const SolvedExtent> extents);

/// "", "[6]", "[ndof<=10]". Context: setup.
std::string shape_text(std::span<const SolvedExtent> extents);

}  // namespace chimera
