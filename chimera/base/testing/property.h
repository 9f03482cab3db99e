// SPDX-License-Identifier: Apache-2.0
// For fuzz targets: what must hold of every input.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace chimera {

/// Aborts, and so tells the fuzzer that it has found something, when `kept` is false. Context: setup.
inline void require(bool kept, const char* property) {
  if (kept) return;
  std::fprintf(stderr, "property broken: %s\n", property);
  std::abort();
}

}  // namespace chimera
