// SPDX-License-Identifier: Apache-2.0
// Input element of the cruise control (2000 paper, figure 15): the accelerator pedal.
#include "library/script/pedal.h"

using namespace chimera;

namespace {

struct Accel : library::Pedal {
  Accel() : Pedal("fra", 2280) {}
};

CHIMERA_COMPONENT(Accel, "accel", "The accelerator pedal, pressed by a script.", rate = 50.0,
                  source = "2000 paper, section 6");

}  // namespace
