// SPDX-License-Identifier: Apache-2.0
// Refuses `init` or `on` from the n-th call on, without exceptions, so that a microcontroller can have it.
#include "chimera/task/component.h"

using namespace chimera;

struct Refuses {
  InConst<Text<8>> where{"where", initial = "none", one_of = "none init on", doc = "the method"};
  InConst<std::int32_t> from{"from", "1", initial = 1, range(1, 1000), doc = "the first call that is refused"};
  Out<std::int32_t> count{"count", "1", initial = 0, doc = "cycles"};

  Outcome init() { return act("init"); }
  Outcome on() { return act("on"); }
  void cycle() { *count += 1; }

 private:
  Outcome act(const char* method) {
    return *where == method && ++calls_ >= *from ? fault("refused on demand", 7) : ok();
  }
  std::int32_t calls_ = 0;
};
CHIMERA_COMPONENT(Refuses, "t_refuses", "Refuses a method on demand.", rate = 1000.0);
