// SPDX-License-Identifier: Apache-2.0
// Nearly the largest outputs that all tasks together may have: 3.9 of 4 MiB.
#include "chimera/task/component.h"

using namespace chimera;

struct Large {
  Out<double[65536]> a{"a", "m", initial = 0.1};
  Out<double[65536]> b{"b", "m", initial = 0.2};
  Out<double[65536]> c{"c", "m", initial = 0.3};
  Out<double[65536]> d{"d", "m", initial = 0.4};
  Out<double[65536]> e{"e", "m", initial = 0.5};
  Out<double[65536]> f{"f", "m", initial = 0.6};
  Out<bool[65536]> g{"g", initial = true};
  Out<bool[65536]> h{"h", initial = true};
  Out<bool[65536]> i{"i", initial = true};
  Out<bool[65536]> j{"j", initial = false};
  Out<bool[65536]> k{"k", initial = false};
  Out<bool[65536]> l{"l", initial = false};
  Out<bool[65536]> m{"m", initial = false};
  Out<double> n{"n", "1", initial = 0.0, doc = "cycles; beside it all others stand still"};

  void cycle() { *n += 1; }
};
CHIMERA_COMPONENT(Large, "t_large", "Outputs of 3.9 MiB.", rate = 1.0);
