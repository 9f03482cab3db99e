// SPDX-License-Identifier: Apache-2.0
// Prints the broken condition and calls abort(). A microcontroller image supplies its own version of this function.
#include "chimera/base/assert.h"

#include <cstdio>
#include <cstdlib>

namespace chimera {

void assertion_failed(const char* condition, const char* file, int line) noexcept {
  std::fprintf(stderr, "%s:%d: broken invariant: %s\n", file, line, condition);
  std::abort();
}

}  // namespace chimera
