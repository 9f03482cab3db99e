// SPDX-License-Identifier: Apache-2.0
// Every fourth cycle reads an index beyond a port: a list, a matrix, a repeated port in turn.
#include "chimera/task/component.h"

using namespace chimera;

struct Beyond {
  Many<In<double>, 3> in{"in*", "1"};
  Out<double[3]> list{"list", "1", initial = 0.0};
  Out<double[2][2]> matrix{"matrix", "1", initial = 0.0};
  Out<std::int64_t> errors{"errors", "1", initial = 0, doc = "calls of error()"};

  void cycle() {
    const std::int64_t n = n_++;
    list[0] = static_cast<double>(n);
    if (n % 4 != 3) return;
    const std::size_t beyond = 4 + static_cast<std::size_t>(n);
    if (n % 12 == 3) list[beyond] = 1;
    else if (n % 12 == 7) matrix(1, beyond) = 1;
    else list[1] = *in[beyond];
  }
  bool error() {
    *errors = ++errors_;
    return true;
  }
  std::int64_t n_ = 0, errors_ = 0;
};
CHIMERA_COMPONENT(Beyond, "t_beyond", "Reads beyond its ports.", rate = 1000.0);
