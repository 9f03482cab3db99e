// SPDX-License-Identifier: Apache-2.0
// A type variable, a unit variable and an extent variable in one component: y is a copy of x, whatever it is.
#include <cstring>

#include "chimera/task/component.h"

using namespace chimera;

struct Generic {
  In<Any[]> x{"x", "U", "[n<=16]", type = "T"};
  Out<Any[]> y{"y", "U", "[n<=16]", type = "T"};
  Out<std::int32_t> size{"size", "1", initial = 0, doc = "elements of x"};

  void cycle() {
    std::memcpy(y.bytes().data(), x.bytes().data(), x.bytes().size());
    *size = static_cast<std::int32_t>(x.size());
  }
};
CHIMERA_COMPONENT(Generic, "t_generic", "Copies any list.", rate = 1000.0);
