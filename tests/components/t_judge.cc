// SPDX-License-Identifier: Apache-2.0
// Counts what must never be seen of t_whole: numbers of two cycles at once, and any that go back.
#include "chimera/task/component.h"

using namespace chimera;

struct Judge {
  In<std::int64_t[256]> number{"number", "ns"};
  In<std::int64_t> sum{"sum", "ns"};
  Out<std::int64_t> seen{"seen", "1", initial = 0, doc = "cycles in which there was something new"};
  Out<std::int64_t> torn{"torn", "1", initial = 0};
  Out<std::int64_t> backward{"backward", "1", initial = 0};
  Out<std::int64_t> invalid{"invalid", "1", initial = 0, doc = "cycles without a value, once there was one"};

  void cycle() {
    if (!number.valid()) {
      if (last_ != 0) ++*invalid;
      return;
    }
    std::int64_t expected = 0;
    bool is_whole = true;
    for (int i = 0; i < 256; ++i) {
      is_whole = is_whole && number[i] == number[0];
      expected += number[i];
    }
    if (!is_whole || *sum != expected) ++*torn;
    if (number[0] < last_) ++*backward;
    if (number[0] != last_) ++*seen;
    last_ = number[0];
  }
  std::int64_t last_ = 0;
};
CHIMERA_COMPONENT(Judge, "t_judge", "Judges what t_whole publishes.", rate = 1000.0);
