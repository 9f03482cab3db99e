// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "chimera/task/abi.h"

namespace chimera {

/// The background function of the component. Null if it has none, or if it was built before this member existed.
/// Context: any; wait-free.
inline chimera_background background_of(const chimera_component& component) noexcept {
  return component.struct_size >= offsetof(chimera_component, event_source) ? component.background : nullptr;
}

}  // namespace chimera
