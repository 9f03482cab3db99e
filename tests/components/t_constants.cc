// SPDX-License-Identifier: Apache-2.0
// A producer of constants, one of which fixes the extent of the other; reinit makes them anew.
#include "chimera/task/component.h"

using namespace chimera;

struct Constants {
  InConst<std::int32_t> joints{"joints", "1", initial = 3, range(1, 10), doc = "for ndof"};
  InConst<double> scale{"scale", "m", initial = 0.5, doc = "length of the first link"};
  OutConst<std::int32_t> ndof{"ndof", "1"};
  OutConst<double[]> length{"length", "m", "[ndof<=10]", doc = "link i is i + 1 times as long as the first"};
  Out<std::int32_t> inits{"inits", "1", initial = 0, doc = "calls of init and reinit so far"};

  void init() {
    ++made_;
    *ndof = *joints;
    for (std::size_t i = 0; i < length.size(); ++i) length[i] = *scale * static_cast<double>(i + 1);
  }
  void reinit() { init(); }
  void cycle() { *inits = made_; }
  std::int32_t made_ = 0;
};
CHIMERA_COMPONENT(Constants, "t_constants", "Gives constants.", rate = 100.0);
