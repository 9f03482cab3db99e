// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "chimera/task/abi.h"

namespace chimera {

/// The function that returns the descriptor of the events. Null if the component has none, or if it was built before
/// this member existed. Context: any; wait-free.
inline chimera_event_source event_source_of(const chimera_component& component) noexcept {
  return component.struct_size >= offsetof(chimera_component, n_orders) ? component.event_source : nullptr;
}

}  // namespace chimera
