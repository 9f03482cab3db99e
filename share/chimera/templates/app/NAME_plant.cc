// SPDX-License-Identifier: Apache-2.0
// @NAME@_plant: a motor that follows its voltage with a delay. Put the driver of yours in its place.
#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@PlantComponent {
  In<double>      u{"u", "V"};
  InConst<double> gain{"gain", "rad/s/V", initial = 10.0};
  InConst<double> time{"time", "s", initial = 0.05, range(1e-3, 1e3)};
  Out<double>     speed{"speed", "rad/s", initial = 0.0};

  void cycle(Cycle c) { *speed += (*gain * *u - *speed) * c.dt() / *time; }
};
CHIMERA_COMPONENT(@TYPE@PlantComponent, "@NAME@_plant", "A motor as a first-order lag.", rate = 1000.0);
