// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "chimera/task/abi.h"

namespace chimera {

/// How the component tells where its events come from; null: nowhere, or it was built before there was such a thing.
/// Context: any; wait-free.
inline chimera_event_source event_source_of(const chimera_component& component) noexcept {
  return component.struct_size >= offsetof(chimera_component, n_orders) ? component.event_source : nullptr;
}

}  // namespace chimera
