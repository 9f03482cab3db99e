// SPDX-License-Identifier: Apache-2.0
// Random bytes that no other process can foresee.
#pragma once

#include <cstddef>
#include <span>

namespace chimera {

/// Fills `to`, at most 256 bytes, from the generator of the kernel. False with errno if the system refuses. Context:
/// setup; blocks until the kernel has enough entropy, once after boot.
bool fill_random(std::span<std::byte> to) noexcept;

}  // namespace chimera
