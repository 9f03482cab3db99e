// SPDX-License-Identifier: Apache-2.0
// Gives a pulse when a truth value changes. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct EdgePulse {
  In<bool[]> x{"x", "1", "[n...<=64]", doc = "Any truth value."};
  InConst<Text<16>> of{"of", "1", initial = "rising", doc = "rising, falling or both."};
  InConst<double> duration{"duration", "s", initial = 0.0, range(0, 86400),
                           doc = "Duration of the pulse; 0: one cycle."};
  Out<bool[]> y{"y", "1", "[n...<=64]", initial = false, doc = "The pulse."};

  Outcome init() {
    rises_ = *of == "rising" || *of == "both";
    falls_ = *of == "falling" || *of == "both";
    if (!rises_ && !falls_) return fault("of must be rising, falling or both");
    if (!(*duration >= 0 && *duration <= 86400)) return fault("duration must be 0 to 86400 s");
    length_ = Nanoseconds{static_cast<std::int64_t>(math::floor(*duration * 1e9 + 0.5))};
    return ok();
  }
  Outcome reinit() { return init(); }
  // A change while the task was off is no edge.
  void on() {
    has_last_ = false;
    for (bool& out : y) out = false;
    for (auto& end : end_) end = {};
  }
  Outcome cycle(Cycle c) {
    if (!x.valid()) return aborted();
    for (std::size_t i = 0; i < y.size(); ++i) {
      const bool is = x.begin()[i], was = has_last_ ? last_[i] : is;
      const bool is_edge = is != was && (is ? rises_ : falls_);
      last_[i] = is;
      if (is_edge) end_[i] = c.now() + length_;
      y.begin()[i] = is_edge || c.now() < end_[i];
    }
    has_last_ = true;
    return ok();
  }

 private:
  bool rises_ = false, falls_ = false, has_last_ = false;
  Nanoseconds length_;
  bool last_[library::kMostElements] = {};
  Nanoseconds end_[library::kMostElements];
};

CHIMERA_COMPONENT(EdgePulse, "edge", "A pulse where a truth value changes.");

}  // namespace
