// SPDX-License-Identifier: Apache-2.0
// One cycle of a component beside the law it computes, written as one would without components: what rows 16 and 19
// are made of. tools/check_bench.py asks that every component of the library stands in such a case.
#pragma once

#include <algorithm>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "chimera/base/testing/tree_path.h"
#include "library/kinematics/testing/arm_rig.h"

namespace chimera::bench {

struct ComponentCase {
  const char* component;
  const char* law;  // the baseline
  std::function<void(library::ArmRig&)> give;  // inputs and constants, before init
  Comparison::Body raw;
  std::function<void(library::ArmRig&)> prepare = {};  // before each turn, not measured
  std::uint64_t limit = 0;                             // cycles a turn; 0: as many as one likes
  Goal goal = {};
};

/// `n` cycles of 1 ms; true when the last of them was well.
inline bool cycles(library::ArmRig& rig, std::uint64_t n) { return rig.repeat(n, milliseconds(1)) == CHIMERA_OK; }

/// Compares and prints one figure. False, with the reason on stderr, when the component refuses its part.
inline bool measure(int row, const ComponentCase& of, int repetitions) try {
  library::ArmRig rig(of.component);
  rig.extent("n", 6);  // wherever a shape is free
  of.give(rig);
  RigAnswer made = rig.init();
  if (made) made = rig.on();
  if (made) made = rig.cycle();
  bool is_well = true;
  if (made) {
    Comparison comparison(repetitions);
    if (of.limit > 0) comparison.limit(of.limit);
    const auto raw = comparison.add(of.law, of.raw);
    const auto ours = comparison.add(
        of.component, [&](std::uint64_t n) { is_well = cycles(rig, n) && is_well; },
        of.prepare ? [&] { of.prepare(rig); } : Comparison::Prepare{});
    comparison.run(raw);
    print(Figure{.row = row, .what = std::string("cycle of ") + of.component, .goal = of.goal}.of(comparison, ours));
  }
  if (!made || !is_well) std::fprintf(stderr, "%s: %s\n", of.component, made ? "a cycle failed" : made.text.c_str());
  return made && is_well;
} catch (const std::exception& wrong) {
  std::fprintf(stderr, "%s is not measured: %s\n", of.component, wrong.what());
  return false;
}

inline int measure(int row, const std::vector<ComponentCase>& cases, int argc, char** argv) {
  bool is_well = true;
  for (const auto& of : cases) is_well = measure(row, of, repetitions(argc, argv, 101)) && is_well;
  return is_well ? 0 : 1;
}

}  // namespace chimera::bench
