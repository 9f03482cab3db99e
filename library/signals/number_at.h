// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>

#include "chimera/task/abi.h"

namespace chimera::library {

/// An element of an Any port as a double: CHIMERA_BOOL to CHIMERA_FLOAT64; an int64 beyond 2^53 is rounded.
/// Context: cycle; wait-free.
inline double number_at(const std::byte* at, std::uint32_t type) noexcept {
  const auto as = [at]<class T>(T value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case CHIMERA_BOOL: return as(std::uint8_t{});
    case CHIMERA_INT32: return as(std::int32_t{});
    case CHIMERA_INT64: return as(std::int64_t{});
    case CHIMERA_FLOAT32: return as(float{});
    default: return as(double{});
  }
}

}  // namespace chimera::library
