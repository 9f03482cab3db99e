// SPDX-License-Identifier: Apache-2.0
// A process that must never be in the way of others.
#pragma once

#include <cstdint>

namespace chimera {

/// From now on this process and its threads give way to all others: the smallest shares of processors, the first to be
/// ended when memory runs out, no core image, and at most `memory` bytes of addresses: an allocation beyond it fails
/// (no such bound under the address and thread sanitizers, which need more). What the system refuses is left out: none
/// of it is needed for being right. Context: setup.
void run_in_background(std::uint64_t memory) noexcept;

}  // namespace chimera
