// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "chimera/task/abi.h"

namespace chimera {

/// The declared orders between constants of the component. Empty if it was built before this member existed. Context:
/// any; wait-free.
inline std::span<const chimera_order> orders_of(const chimera_component& component) noexcept {
  if (component.struct_size < offsetof(chimera_component, n_choices) || component.orders == nullptr) return {};
  return {component.orders, component.n_orders};
}

}  // namespace chimera
