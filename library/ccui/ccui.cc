// SPDX-License-Identifier: Apache-2.0
// The user interface of the cruise control (2000 paper, figure 15), operated by a script.
#include "chimera/task/component.h"
#include "library/script/script.h"

using namespace chimera;

namespace {

struct Ccui {
  Out<double> vr{"vr",   "m/s",        initial = 0.0,
                 safety, range(0, 70), doc = "Speed to hold; 0: off."};
  Resource buttons{"buttons", safe_state,
                   doc = "Script of seconds:km/h, each held until the next; \"0:0\": always off."};

  Outcome init() {
    const char* const wrong = speed_.read(buttons.text(), 0, 250, "a set speed is 0 to 250 km/h");
    return wrong == nullptr ? ok() : fault(wrong);
  }
  Outcome reinit() { return init(); }
  void on() {
    elapsed_ = 0;
    *vr = speed_.step(0) / 3.6;
  }
  void cycle(Cycle c) {
    elapsed_ += c.dt();
    *vr = speed_.step(elapsed_) / 3.6;
  }
  void off() { *vr = 0; }

 private:
  library::Script speed_;
  double elapsed_ = 0;
};

CHIMERA_COMPONENT(Ccui, "ccui", "User interface of the cruise control, operated by a script.", rate = 10.0,
                  source = "2000 paper, section 6");

}  // namespace
