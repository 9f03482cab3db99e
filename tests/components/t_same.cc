// SPDX-License-Identifier: Apache-2.0
// Counts the cycles in which two signals are not equal to the bit.
#include <cstdint>

#include "chimera/task/component.h"

using namespace chimera;

struct Same {
  In<double[]>      a{"a", "U", "[n...<=64]", intermittent};
  In<double[]>      b{"b", "U", "[n...<=64]", intermittent};
  Out<std::int64_t> compared{"compared", "1", initial = std::int64_t{0}};
  Out<std::int64_t> different{"different", "1", initial = std::int64_t{0}};

  void cycle() {
    ++*compared;
    if (__builtin_memcmp(a.begin(), b.begin(), a.size() * sizeof(double)) != 0) ++*different;
  }
};
CHIMERA_COMPONENT(Same, "t_same", "Counts the cycles in which two signals differ.", rate = 100.0);
