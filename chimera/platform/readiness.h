// SPDX-License-Identifier: Apache-2.0
// Waiting until a descriptor has something to read.
#pragma once

#include <span>

#include "chimera/base/time.h"

namespace chimera {

/// Waits until one of `descriptors` (a number below 0 is left out) is readable, has failed or is closed, at most
/// `limit` (kNever: without end). False when none was within the limit, or when a signal handler ran.
/// At most 64 descriptors are waited for. Context: setup; blocks.
bool await_readable(std::span<const int> descriptors, Nanoseconds limit) noexcept;

}  // namespace chimera
