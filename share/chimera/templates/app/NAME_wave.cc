// SPDX-License-Identifier: Apache-2.0
// @NAME@_wave: a sine to begin with.
#include <cmath>

#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@WaveComponent {
  InConst<double> amplitude{"amplitude", "m", initial = 1.0};
  InConst<double> frequency{"frequency", "Hz", initial = 1.0, range(0, 1000)};
  Out<double>     wave{"wave", "m", initial = 0.0, doc = "amplitude sin(2 pi frequency t), t from on"};

  void on() { t_ = 0; }
  void cycle(Cycle c) {
    t_ += c.dt();
    *wave = *amplitude * std::sin(6.283185307179586 * *frequency * t_);
  }
  double t_ = 0;
};
CHIMERA_COMPONENT(@TYPE@WaveComponent, "@NAME@_wave", "A sine.", rate = 100.0);
