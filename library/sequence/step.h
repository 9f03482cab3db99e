// SPDX-License-Identifier: Apache-2.0
// One step, as the constant `step` has it.
#pragma once

#include <cstdint>
#include <tuple>

#include "chimera/task/component.h"

namespace chimera::library {

struct Step {
  Text<72> name;
  double within = 0, wait = 0;  ///< as SequenceStep, in s
  std::int32_t input = -1;      ///< of the condition, among the repeated ports; below 0: none
  std::int32_t element = 0;
  std::int32_t relation = 0;    ///< < <= > >= == !=
  std::int32_t otherwise = -1;
  bool confirm = false, reentry = false;
};

}  // namespace chimera::library

template <>
struct chimera::Fields<chimera::library::Step> {
  using Step = chimera::library::Step;
  static constexpr const char* name = "sequence_step";
  static constexpr auto list =
      std::tuple{field("name", "1", &Step::name),           field("within", "s", &Step::within),
                 field("wait", "s", &Step::wait),           field("input", "1", &Step::input),
                 field("element", "1", &Step::element),     field("relation", "1", &Step::relation),
                 field("otherwise", "1", &Step::otherwise), field("confirm", "1", &Step::confirm),
                 field("reentry", "1", &Step::reentry)};
};
