// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "chimera/task/abi.h"

namespace chimera {

/// The legal words of text constants of the component. Empty if it was built before this member existed. Context: any;
/// wait-free.
inline std::span<const chimera_choice> choices_of(const chimera_component& component) noexcept {
  if (component.struct_size < offsetof(chimera_component, host_size) || component.choices == nullptr) return {};
  return {component.choices, component.n_choices};
}

}  // namespace chimera
