// SPDX-License-Identifier: Apache-2.0
// How far apart two values of one state variable are, and whether a switch may make that step.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/task/task_spec.h"

namespace chimera {

/// The element of a variable that moved farthest, measured by its limit where there is one.
struct ValueStep {
  double size = 0;   ///< |after - before| of that element; NaN: one of the two is not a number
  double limit = 0;  ///< PortSpec::max_step there; 0: none
  bool is_known = false;   ///< false: texts, or nobody had written a value
  bool is_beyond = false;  ///< some element moved farther than its limit

  constexpr bool operator==(const ValueStep&) const noexcept = default;
};

/// Compares the first `count` elements of an out-var. A boolean counts as 0 or 1; of a struct every field counts.
/// `declared` is the component's declaration of the port. Requires: max_bytes() of the port at both. Context: cycle
/// boundary; wait-free; O(elements).
ValueStep step_between(const PortSpec& port, const chimera_port_decl& declared, std::uint32_t count,
                       const std::byte* before, const std::byte* after) noexcept;

}  // namespace chimera
