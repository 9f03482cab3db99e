// SPDX-License-Identifier: Apache-2.0
// Fails in the configured method and way.
#include <stdexcept>

#include "chimera/task/component.h"

using namespace chimera;

struct Thrower {
  InConst<Text<16>> where{"where", initial = "", doc = "the method that fails; empty: none"};
  InConst<std::int32_t> how{"how", "1", initial = 1, range(1, 5),
                            doc = "1 std::exception, 2 int, 3 fault(), 4 text, 5 aborted()"};
  InConst<std::int64_t> at{"at", "1", initial = 0, doc = "calls of that method that go well before one fails"};
  InConst<std::int64_t> times{"times", "1", initial = 1, doc = "calls that fail then; -1: all"};
  InConst<bool> recovers{"recovers", initial = true, doc = "what error() answers"};
  InConst<bool> clears{"clears", initial = true, doc = "what clear() answers"};
  Out<std::int64_t> count{"count", "1", initial = 0, doc = "cycles that went well"};
  Out<std::int64_t> errors{"errors", "1", initial = 0, doc = "calls of error()"};

  Outcome init() { return act("init"); }
  Outcome reinit() { return act("reinit"); }
  Outcome on() { return act("on"); }
  Outcome cycle() {
    *count = -1;  // not published when the cycle fails
    const Outcome outcome = act("cycle");
    if (outcome.status() == CHIMERA_OK) *count = ++good_;
    return outcome;
  }
  Outcome off() { return act("off"); }
  Outcome kill() { return act("kill"); }
  Outcome error() {
    *errors = ++errors_;
    const Outcome outcome = act("error");
    return outcome.status() != CHIMERA_OK || *recovers ? outcome : fault("told not to recover");
  }
  Outcome clear() {
    const Outcome outcome = act("clear");
    return outcome.status() != CHIMERA_OK || *clears ? outcome : fault("told not to clear");
  }

 private:
  Outcome act(const char* method) {
    if (!(*where == method)) return ok();
    const std::int64_t call = calls_++;
    if (call < *at || (*times >= 0 && call >= *at + *times)) return ok();
    switch (*how) {
      case 1: throw std::runtime_error("thrown on demand");
      case 2: throw 42;
      case 3: return fault("refused on demand", 7);
      case 4: throw "text on demand";
      default: return aborted();
    }
  }
  std::int64_t calls_ = 0, good_ = 0, errors_ = 0;
};
CHIMERA_COMPONENT(Thrower, "t_thrower", "Fails on demand.", rate = 1000.0);
