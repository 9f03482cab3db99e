// SPDX-License-Identifier: Apache-2.0
// One port of every plain type, in and out.
#include "chimera/task/component.h"

using namespace chimera;

struct Values {
  In<bool> flag{"flag"};
  In<std::int32_t> small{"small", "1"};
  In<std::int64_t> large{"large", "1"};
  In<float> single{"single", "m"};
  In<double> real{"real", "m"};
  In<Text<32>> text{"text"};
  Out<bool> not_flag{"not_flag", initial = true};
  Out<std::int32_t> small_next{"small_next", "1", initial = 0, doc = "small + 1"};
  Out<std::int64_t> large_next{"large_next", "1", initial = 0, doc = "large + 1"};
  Out<float> single_half{"single_half", "m", initial = 0};
  Out<double> real_half{"real_half", "m", initial = 0};
  Out<Text<32>> echo{"echo", initial = "idle"};
  Out<Text<8>[2]> words{"words", initial = "-"};

  void cycle() {
    *not_flag = !*flag;
    *small_next = *small + 1;
    *large_next = *large + 1;
    *single_half = *single / 2;
    *real_half = *real / 2;
    *echo = *text;
    words[0] = "one";
    words[1] = "two";
  }
};
CHIMERA_COMPONENT(Values, "t_values", "Every plain type.", rate = 1000.0);
