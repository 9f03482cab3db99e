// SPDX-License-Identifier: Apache-2.0
// Asks the kernel for random bytes.
#include "chimera/platform/random.h"

#include <unistd.h>

namespace chimera {

bool fill_random(std::span<std::byte> to) noexcept { return ::getentropy(to.data(), to.size()) == 0; }

}  // namespace chimera
