// SPDX-License-Identifier: Apache-2.0
// For tests: an application of two rtpus whose tasks exchange a variable, and an operator variable.
#pragma once

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::testing {

struct Maker {
  Out<double> a{"a", "1", initial = 1.0};
  Out<double> b{"b", "1", initial = 2.0};
  OutConst<std::int32_t> n{"n", "1"};
  void init() { *n = 3; }
  void cycle(Cycle) {}
};

struct Taker {
  In<double> a{"a", "1"};
  In<double> gain{"gain", "1"};
  void cycle(Cycle) {}
};

inline constexpr TaskId kMaker{0u}, kTaker{1u};

/// The taker is on the first rtpu, the maker on the second; `gain` is 0.5.
struct TwoRtpus {
  TwoRtpus() {
    app.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app.add("maker", component<Maker>("maker")).rtpu = RtpuId(1u);
    app.add("taker", component<Taker>("taker")).rtpu = RtpuId(0u);
    app.give(app.operators, "gain", CHIMERA_FLOAT64, bytes_of(0.5));
    app.make();
  }

  TestApplication app;
  HeapMemory heap;
};

}  // namespace chimera::testing
