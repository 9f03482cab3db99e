// SPDX-License-Identifier: Apache-2.0
// A fuzz target that aborts for every input that begins with x: tests/frame/replay_corpus.py replays such inputs.
#include <cstdint>

#include "chimera/base/testing/property.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  chimera::require(size == 0 || bytes[0] != 'x', "no input begins with x");
  return 0;
}
