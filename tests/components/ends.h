// SPDX-License-Identifier: Apache-2.0
// What t_ends and t_ends_event do: one method that ends badly, in any of the ways a method can.
#pragma once

#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "chimera/task/component.h"

using namespace chimera;  // NOLINT: part of component sources only

struct Ends {
  InConst<Text<16>> where{"where", initial = "", doc = "the method that ends badly; empty: none"};
  InConst<Text<16>> how{"how", initial = "throw",
                                          doc = "throw fault segv abort kill exit loop sleep late (late: after 30 s)"};
  Resource armed{"armed", shared, doc = "the file whose existence lets it happen"};
  Out<std::int64_t> n{"n", "1", initial = 0, doc = "cycles of this incarnation"};

  Outcome init() { return act("init"); }
  Outcome reinit() { return act("reinit"); }
  Outcome on() { return act("on"); }
  Outcome cycle() {
    const bool is_to_fail = (is_where("error") || is_where("clear")) && is_armed();
    cycles_ = cycles_ + 1;
    *n = cycles_;
    return is_to_fail ? fault("so that error is called") : act("cycle");
  }
  Outcome off() { return act("off"); }
  Outcome kill() { return act("kill"); }
  Outcome error() {
    const Outcome outcome = act("error");
    return is_where("clear") ? fault("so that clear is called") : outcome;
  }
  Outcome clear() { return act("clear"); }

 protected:
  Outcome act(const char* method) {
    if (!is_where(method) || !is_armed()) return ok();
    for (const auto& [way, number] :
         {std::pair{"segv", SIGSEGV}, std::pair{"abort", SIGABRT}, std::pair{"kill", SIGKILL}})
      if (*how == way) ::raise(number), ::pause();
    if (*how == "exit") ::_exit(0);  // as if all were well
    if (*how == "late") ::sleep(30);
    while (*how == "sleep") ::pause();
    while (*how == "loop") cycles_ = cycles_ + 1;
    if (*how == "throw") throw std::runtime_error("thrown on demand");
    return *how == "fault" ? fault("refused on demand", 7) : ok();
  }

 private:
  bool is_where(const char* method) const { return *where == method; }
  bool is_armed() const { return ::access(armed.c_str(), F_OK) == 0; }
  volatile std::int64_t cycles_ = 0;
};
