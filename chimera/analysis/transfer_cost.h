// SPDX-License-Identifier: Apache-2.0
// The data that a task copies at each cycle between its own memory and tables that other tasks write concurrently.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/verify/configuration.h"

namespace chimera {

/// Part of the time of a cycle.
struct TransferCost {
  std::uint32_t groups = 0;  ///< one for each producer
  std::uint32_t bytes = 0;   ///< at most: of the largest shapes
};

/// Groups and bytes that come from another rtpu or from the operator, and from tasks of a preemptive rtpu of its own,
/// which read each other like strangers. Context: setup.
TransferCost transfer_of(const Configuration& configuration, std::size_t task);

}  // namespace chimera
