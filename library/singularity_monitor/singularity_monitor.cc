// SPDX-License-Identifier: Apache-2.0
// Detects when the arm comes near a singular pose: the time to change from figure 8 of the 1994 paper to figure 9.
#include "chimera/task/component.h"
#include "library/kinematics/singular_values.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct SingularityMonitor {
  In<Matrix<double>> jv{"jv", "m/rad", "[3][ndof<=10]", frame = "base", doc = "Tool velocity by joint speeds."};
  In<Matrix<double>> jw{"jw", "1", "[3][ndof<=10]", frame = "base", doc = "Angular tool velocity by joint speeds."};
  Out<double> singular_value{"singular_value", "1", initial = 0.0, doc = "Least singular value of the Jacobian."};
  Out<double> isotropy{"isotropy", "1", initial = 0.0,
                       doc = "Least by greatest: 1: all directions alike; 0: singular."};
  Out<bool> is_near{"is_near", "1", initial = true, doc = "Near a singular pose."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<double> near{"near", "1", initial = 0.05, range(1e-9, 10), doc = "Singular value below which is_near rises."};
  InConst<double> clear_of{"clear_of", "1", initial = 0.08, range(1e-9, 10), at_least = "near",
                           doc = "Singular value above which is_near falls."};
  InConst<double> length{"length", "m", initial = 1.0, range(1e-3, 100),
                         doc = "Tool motion that counts as one radian."};
  InConst<Text<64>> when_near{"when_near", "1", initial = "", configuration,
                              doc = "Configuration to request when is_near rises."};
  InConst<Text<64>> when_clear{"when_clear", "1", initial = "", configuration,
                               doc = "Configuration to request after dwell."};
  InConst<double> dwell{"dwell", "s", initial = 0.5, range(0, 3600),
                        doc = "Time without is_near before when_clear is requested."};

  Outcome init() { return *clear_of >= *near ? ok() : fault("clear_of is below near: is_near would chatter"); }
  Outcome reinit() { return init(); }
  Outcome on(Cycle c) {
    *is_near = true;
    has_asked_ = false;
    return library::awaited(cycle(c));
  }
  Outcome cycle(Cycle c) {
    library::Jacobian jacobian;
    for (std::size_t i = 0; i < jv.columns(); ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        jacobian.linear[i][r] = jv(r, i);
        jacobian.angular[i][r] = jw(r, i);
      }
    }
    const library::SingularValues values(jacobian, jv.columns(), *length);
    if (!values.are_finite()) return library::unfit("the Jacobian is not finite, or too large", jv, jw);
    *singular_value = values.least();
    *isotropy = values.greatest() > 0 ? values.least() / values.greatest() : 0;
    *is_near = values.least() < (*is_near ? *clear_of : *near);
    ask(c);
    return ok();
  }
  bool error() { return true; }

 private:
  // Requests once for each approach, and once after dwell without is_near. Two requests are at least dwell apart.
  void ask(Cycle c) {
    if (*is_near) last_near_ = c.now();
    const bool is_to_ask = *is_near ? !has_asked_ : has_asked_ && to_seconds(c.now() - last_near_) >= *dwell;
    if (!is_to_ask) return;
    has_asked_ = *is_near;
    const Text<64>& name = *is_near ? *when_near : *when_clear;
    if (!name.empty()) c.request(name.c_str());  // the framework reports a refusal
  }

  Nanoseconds last_near_;
  bool has_asked_ = false;  // when_near is requested, when_clear not yet
};

CHIMERA_COMPONENT(SingularityMonitor, "singularity_monitor", "Detects when an arm comes near a singular pose.",
                  rate = 1000.0, source = "1994 paper, figures 8 and 9; Hestenes 1958; Klein and Blaho 1987");

}  // namespace
