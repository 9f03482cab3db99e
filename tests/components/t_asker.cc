// SPDX-License-Identifier: Apache-2.0
// Requests a configuration in every cycle while its input says so.
#include "chimera/task/component.h"

using namespace chimera;

struct Asker {
  In<double> wish{"wish", "1", doc = "0: asks for nothing, 1: for `first`, 2: for `second`"};
  InConst<Text<32>> first{"first", "1", initial = "", configuration, doc = "a configuration"};
  InConst<Text<32>> second{"second", "1", initial = "", configuration, doc = "a configuration"};
  InConst<Text<32>> none{"none", "1", initial = "-", configuration, doc = "is asked for never: no lists"};
  Out<std::int64_t> refused{"refused", "1", initial = 0, doc = "requests that were refused"};

  void cycle(Cycle c) {
    if (*wish != 1 && *wish != 2) return;
    if (!c.request((*wish == 1 ? *first : *second).c_str())) ++*refused;
  }
};
CHIMERA_COMPONENT(Asker, "t_asker", "Asks for a configuration.", rate = 100.0);
