// SPDX-License-Identifier: Apache-2.0
// Input element of the cruise control (2000 paper, figure 15): the brake pedal.
#include "chimera/task/component.h"
#include "library/script/script.h"

using namespace chimera;

namespace {

struct Brake {
  Out<double> frb{"frb", "N", initial = 0.0, safety, range(0, 20000), doc = "Force the driver asks for; 0: foot off."};
  InConst<double> full_force{"full_force", "N", initial = 12000.0, range(0, 20000), doc = "With the pedal down."};
  Resource pedal{"pedal", doc = "Script of seconds:travel, 0 to 1, straight lines between; \"0:0\" is never touched."};

  Outcome init() {
    if (const char* wrong = travel_.read(pedal.text())) return fault(wrong);
    if (travel_.least() < 0 || travel_.greatest() > 1) return fault("the travel of a pedal is 0 to 1");
    if (!(*full_force >= 0 && *full_force <= 20000)) return fault("full_force is 0 to 20000 N");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() {
    elapsed_ = 0;
    *frb = travel_.line(0) * *full_force;
  }
  void cycle(Cycle c) {
    elapsed_ += c.dt();
    *frb = travel_.line(elapsed_) * *full_force;
  }
  void off() { *frb = 0; }

 private:
  library::Script travel_;
  double elapsed_ = 0;
};

CHIMERA_COMPONENT(Brake, "brake", "The brake pedal, pressed by a script.", rate = 50.0,
                  source = "2000 paper, section 6");

}  // namespace
