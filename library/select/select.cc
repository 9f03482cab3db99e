// SPDX-License-Identifier: Apache-2.0
// Passes on the input with a given number. README.md is the data sheet.
#include <algorithm>

#include "chimera/base/message.h"
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

struct Select {
  Many<In<double[]>> in{"in*", "U", "[n...<=64]", doc = "Inputs to choose from."};
  In<std::int32_t>   which{"which", "1", range(0, 15), doc = "Number of the selected input, from 0."};
  Out<double[]>      out{"out", "U", "[n...<=64]", doc = "Values of the selected input."};

  Outcome init() const {
    return in.size() > 0 ? ok() : fault("there is nothing to choose from: name at least one input");
  }
  void on() {
    if (is_named() && library::all_finite(in[number()])) hand_on();
  }
  Outcome cycle() {
    if (!which.valid()) return aborted();
    if (!is_named())
      return fault((Message("which is ") << *which << ", and there are " << in.size() << " inputs").view());
    char name[16];
    const Outcome input = library::judge(in[number()], name_of(name));
    if (library::is_ok(input)) hand_on();
    return input;
  }
  bool error() { return true; }

 private:
  bool is_named() const { return *which >= 0 && static_cast<std::size_t>(*which) < in.size(); }
  std::size_t number() const { return static_cast<std::size_t>(*which); }
  // Avoids formatted output, because every cycle calls it.
  const char* name_of(char* name) const {
    char* at = std::copy_n("in[", 3, name);
    if (*which >= 10) *at++ = '1';
    *at++ = static_cast<char>('0' + *which % 10);
    *at++ = ']', *at = '\0';
    return name;
  }
  void hand_on() { std::copy(in[number()].begin(), in[number()].end(), out.begin()); }
};
CHIMERA_COMPONENT(Select, "select", "Passes on the input with a given number.");
