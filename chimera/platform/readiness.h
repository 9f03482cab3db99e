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

struct Watched {
  int descriptor = -1;     ///< a number below 0 is left out
  bool for_room = false;   ///< waited for until it takes something, not until there is something to read
  bool is_ready = false;   ///< it is so, has failed or is closed
  bool is_lost = false;    ///< no descriptor of this process has that number
};

/// Waits as await_readable() and says which are ready. How many; 0: none within the limit; -1: a signal handler ran.
/// At most 64. Context: setup; blocks.
int await_ready(std::span<Watched> watched, Nanoseconds limit) noexcept;

}  // namespace chimera
