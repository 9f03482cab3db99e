// SPDX-License-Identifier: Apache-2.0
// Extents: given by a constant, literal, and two-dimensional.
#include "chimera/task/component.h"

using namespace chimera;

struct Extents {
  InConst<std::int32_t> ndof{"ndof", "1"};
  InConst<double[]> length{"length", "m", "[ndof<=10]"};
  In<double[]> q{"q", "rad", "[ndof<=10]"};
  Out<double[]> arc{"arc", "m.rad", "[ndof<=10]", initial = 0.0, doc = "length[i] q[i]"};
  Out<Matrix<double>> outer{"outer", "rad2", "[ndof<=10][ndof<=10]", initial = 0.0, doc = "q[i] q[j]"};
  Out<double[3][3]> identity{"identity", "1", initial = 0.0};
  Out<double[3]> last{"last", "1", initial = {1.0, 2.0, 3.0}};

  void cycle() {
    for (std::size_t i = 0; i < q.size(); ++i) {
      arc[i] = length[i] * q[i];
      for (std::size_t j = 0; j < q.size(); ++j) outer(i, j) = q[i] * q[j];
    }
    for (std::size_t i = 0; i < 3; ++i) identity[i][i] = 1;
  }
};
CHIMERA_COMPONENT(Extents, "t_extent", "Lists and matrices of given extent.", rate = 1000.0);
