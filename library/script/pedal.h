// SPDX-License-Identifier: Apache-2.0
// The pedals of the cruise control (2000 paper, figure 15), moved by a script.
#pragma once

#include "chimera/task/component.h"
#include "library/script/script.h"

namespace chimera::library {

/// A pedal with the out-var `output`. At full travel it asks for `full` newtons.
struct Pedal {
  Out<double> force;
  InConst<double> full_force;
  Resource pedal{"pedal", safe_state, shared,
                 doc = "Script of seconds:travel, 0 to 1, straight lines between; \"0:0\": never pressed."};

  Outcome init() {
    if (const char* wrong = travel_.read(pedal.text(), 0, 1, "the travel of a pedal is 0 to 1")) return fault(wrong);
    if (!(*full_force >= 0 && *full_force <= 20000)) return fault("full_force is 0 to 20000 N");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() {
    elapsed_ = 0;
    *force = travel_.line(0) * *full_force;
  }
  void cycle(Cycle c) {
    elapsed_ += c.dt();
    *force = travel_.line(elapsed_) * *full_force;
  }
  void off() { *force = 0; }

 protected:
  Pedal(component_api::PortName output, double full)
      : force{output, "N", initial = 0.0, safety, range(0, 20000), doc = "Force the driver asks for; 0: foot off."},
        full_force{"full_force", "N", initial = full, range(0, 20000), doc = "With the pedal down."} {}

 private:
  Script travel_;
  double elapsed_ = 0;
};

}  // namespace chimera::library
