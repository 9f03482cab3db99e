// SPDX-License-Identifier: Apache-2.0
// Input element of the cruise control (2000 paper, figure 15): the brake pedal.
#include "library/script/pedal.h"

using namespace chimera;

namespace {

struct Brake : library::Pedal {
  Brake() : Pedal("frb", 12000) {}
};

CHIMERA_COMPONENT(Brake, "brake", "The brake pedal, pressed by a script.", rate = 50.0,
                  source = "2000 paper, section 6");

}  // namespace
