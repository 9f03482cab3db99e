// SPDX-License-Identifier: Apache-2.0
// Checks properties in fuzz targets that must hold for every input.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace chimera {

/// Aborts if `kept` is false, so that the fuzzer records the input. Context: setup.
inline void require(bool kept, const char* property) {
  if (kept) return;
  std::fprintf(stderr, "property broken: %s\n", property);
  std::abort();
}

}  // namespace chimera
