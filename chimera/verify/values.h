// SPDX-License-Identifier: Apache-2.0
// Written values as the bytes of a port: converted to its unit, broadcast to its shape, held against its range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chimera/verify/model.h"

namespace chimera {

/// What a value has to fit: one port, solved.
struct ValueTarget {
  const LinkedPort& port;
  std::string what;      ///< for messages: "constant 'scale' of task 'left'"
  bool is_step = false;  ///< the largest step of a value: above 0, the declared range does not count
};

/// The bytes of `node` for the target: its elements at their maxima, those beyond the written ones zero; a value
/// that is not a list fills all. nullopt, with every fault added, when it does not fit. Requires: the port's type,
/// unit and shape are solved. Context: setup.
std::optional<std::vector<std::byte>> value_bytes(Model& model, const Node& node, const ValueTarget& target);

/// A declared initial value or default, broadcast to the port's solved shape. Context: setup.
std::vector<std::byte> declared_bytes(const LinkedPort& port);

/// Whether the port's type, unit and shape are all known. Context: setup.
bool is_solved(const LinkedPort& port);

/// Elements at the maxima. Context: setup.
std::uint32_t element_count(std::span<const SolvedExtent> extents);

/// "", "[6]", "[ndof<=10]". Context: setup.
std::string shape_text(std::span<const SolvedExtent> extents);

}  // namespace chimera
