// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "chimera/task/abi.h"

namespace chimera {

/// What the component does beside its cycles; null: nothing, or it was built before there was such a thing.
/// Context: any; wait-free.
inline chimera_background background_of(const chimera_component& component) noexcept {
  return component.struct_size >= offsetof(chimera_component, event_source) ? component.background : nullptr;
}

}  // namespace chimera
