// SPDX-License-Identifier: Apache-2.0
// Combines truth values to one. README.md is the data sheet.
#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct Logic {
  Many<In<bool[]>> in{"in*", "1", "[n...<=64]", doc = "Truth values to combine."};
  Many<InConst<bool>> inverted{"inverted*", "1", initial = false,
                               doc = "Negates an input; one for each input, or none."};
  InConst<Text<16>> function{"function", "1", doc = "and, or, xor, nand, nor, xnor, not or latch."};
  Out<bool> out{"out", "1", initial = false, doc = "Result."};

  Outcome init() {
    if (in.size() == 0) return fault("there is nothing to combine: name at least one input");
    if (inverted.size() != 0 && inverted.size() != in.size()) return fault("give one inverted for each input, or none");
    if (!find_function()) return fault("function must be and, or, xor, nand, nor, xnor, not or latch");
    if (*function == "not" && in.size() != 1) return fault("not has one input");
    if (function_ == Function::kLatch && in.size() != 2)
      return fault("a latch has two inputs: the first sets it, the second resets it");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() {
    if (is_written()) combine();
  }
  Outcome cycle() {
    if (!is_written()) return aborted();
    combine();
    return ok();
  }

 private:
  enum class Function { kAnd, kOr, kXor, kLatch };

  bool find_function() {
    const Text<16>& name = *function;
    is_turned_ = name == "nand" || name == "nor" || name == "xnor" || name == "not";
    if (name == "and" || name == "nand") return function_ = Function::kAnd, true;
    if (name == "or" || name == "nor" || name == "not") return function_ = Function::kOr, true;
    if (name == "xor" || name == "xnor") return function_ = Function::kXor, true;
    if (name == "latch") return function_ = Function::kLatch, true;
    return false;
  }
  bool is_written() const {
    for (const auto& port : in)
      if (!port.valid()) return false;
    return true;
  }
  /// True if any element of input `k` is true.
  bool any(std::size_t k) const {
    bool found = false;
    for (const bool element : in[k]) found |= element != is_inverted(k);
    return found;
  }
  bool is_inverted(std::size_t k) const { return inverted.size() != 0 && *inverted[k]; }
  void combine() {
    if (function_ == Function::kLatch) {
      *out = !any(1) && (*out || any(0));
      return;
    }
    std::size_t count = 0, all = 0;
    for (std::size_t k = 0; k < in.size(); ++k) {
      for (const bool element : in[k]) count += element != is_inverted(k) ? 1 : 0;
      all += in[k].size();
    }
    const bool result = function_ == Function::kAnd  ? count == all
                        : function_ == Function::kOr ? count > 0
                                                     : count % 2 == 1;
    *out = result != is_turned_;
  }

  Function function_ = Function::kAnd;
  bool is_turned_ = false;
};

CHIMERA_COMPONENT(Logic, "logic", "One truth value of several: and, or, xor, not, latch.");

}  // namespace
