// SPDX-License-Identifier: Apache-2.0
// Says when the arm comes near a singular pose: when to change from figure 8 of the 1994 paper to figure 9.
#include "chimera/task/component.h"
#include "library/kinematics/singular_values.h"

using namespace chimera;

namespace {

struct SingularityMonitor {
  In<Matrix<double>> jv{"jv", "m/rad", "[3][ndof<=10]", frame = "base", doc = "Tool velocity by joint speeds."};
  In<Matrix<double>> jw{"jw", "1", "[3][ndof<=10]", frame = "base", doc = "Angular tool velocity by joint speeds."};
  Out<double> singular_value{"singular_value", "1", initial = 0.0,
                             doc = "The least of the Jacobian: tool motion by joint motion in the hardest direction."};
  Out<double> isotropy{"isotropy", "1", initial = 0.0,
                       doc = "The least by the greatest: 1 where all directions are alike, 0 where singular."};
  Out<bool> is_near{"is_near", "1", initial = true, doc = "Near a singular pose."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<double> near{"near", "1", initial = 0.05, range(1e-9, 10), doc = "Singular value below which it is near."};
  InConst<double> clear_of{"clear_of", "1", initial = 0.08, range(1e-9, 10), at_least = "near",
                           doc = "Singular value above which it is near no more; at least near."};
  InConst<double> length{"length", "m", initial = 1.0, range(1e-3, 100),
                         doc = "Motion of the tool that counts as much as one radian."};

  Outcome init() { return *clear_of >= *near ? ok() : fault("clear_of is below near: is_near would chatter"); }
  Outcome reinit() { return init(); }
  Outcome on() {
    *is_near = true;
    return cycle();
  }
  Outcome cycle() {
    library::Jacobian jacobian;
    for (std::size_t i = 0; i < jv.columns(); ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        jacobian.linear[i][r] = jv(r, i);
        jacobian.angular[i][r] = jw(r, i);
      }
    }
    const library::SingularValues values(jacobian, jv.columns(), *length);
    if (!values.are_finite()) return fault("the Jacobian is not finite, or too large");
    *singular_value = values.least();
    *isotropy = values.greatest() > 0 ? values.least() / values.greatest() : 0;
    *is_near = values.least() < (*is_near ? *clear_of : *near);
    return ok();
  }
};

CHIMERA_COMPONENT(SingularityMonitor, "singularity_monitor", "Says when an arm comes near a singular pose.",
                  rate = 1000.0, source = "1994 paper, figures 8 and 9; Hestenes 1958; Klein and Blaho 1987");

}  // namespace
