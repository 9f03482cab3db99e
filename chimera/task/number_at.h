// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "chimera/task/abi.h"

namespace chimera {

/// An element of a port as a double, for components that learn its type from the description (`In<Any>`): CHIMERA_BOOL
/// to CHIMERA_FLOAT64. An int64 beyond 2^53 is rounded; any other type gives 0. Context: cycle; wait-free.
inline double number_at(std::uint32_t type, const std::byte* at) noexcept {
  const auto as = [at]<class T>(T value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case CHIMERA_BOOL: return as(std::uint8_t{});
    case CHIMERA_INT32: return as(std::int32_t{});
    case CHIMERA_INT64: return as(std::int64_t{});
    case CHIMERA_FLOAT32: return as(float{});
    case CHIMERA_FLOAT64: return as(double{});
    default: return 0;
  }
}

}  // namespace chimera
