// SPDX-License-Identifier: Apache-2.0
// Counts rising edges, up and down. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

constexpr double kMostCount = 9007199254740992.0;  // 2^53: the greatest exact count in a description

struct EdgeCounter {
  In<bool[]> up{"up", "1", "[n...<=64]", doc = "Each rising edge counts one up."};
  In<bool[]> down{"down", "1", "[n...<=64]", doc = "Each rising edge counts one down."};
  In<bool[]> reset{"reset", "1", "[n...<=64]", doc = "While true, the count is the preset."};
  InConst<std::int64_t[]> preset{
      "preset", "1", "[n...<=64]", initial = 0, range(-kMostCount, kMostCount), doc = "First count."};
  InConst<std::int64_t[]> low{
      "low", "1", "[n...<=64]", initial = -kMostCount, range(-kMostCount, kMostCount), doc = "Least count."};
  InConst<std::int64_t[]> high{"high",
                               "1",
                               "[n...<=64]",
                               initial = kMostCount,
                               range(-kMostCount, kMostCount),
                               at_least = "low",
                               doc = "Greatest count."};
  InConst<bool> wraps{"wraps", "1", initial = false,
                      doc = "At one end the count continues at the other; false: it holds."};
  Out<std::int64_t[]> count{"count", "1", "[n...<=64]", initial = 0, doc = "The count."};
  Out<bool[]> at_high{"at_high", "1", "[n...<=64]", initial = false, doc = "The count is at high."};

  Outcome init() {
    is_preset_ = false;
    return judge();
  }
  Outcome reinit() { return judge(); }
  // Continues from the last count. Edges while the task was off do not count.
  void on() {
    has_last_ = false;
    for (std::size_t i = 0; i < count.size(); ++i) publish(i, is_preset_ ? count[i] : preset[i]);
    is_preset_ = true;
  }
  Outcome cycle() {
    if (!up.valid() || !down.valid() || !reset.valid()) return aborted();
    for (std::size_t i = 0; i < count.size(); ++i) {
      const bool is_up = up.begin()[i], is_down = down.begin()[i];
      const int step = has_last_ ? (is_up && !was_up_[i] ? 1 : 0) - (is_down && !was_down_[i] ? 1 : 0) : 0;
      was_up_[i] = is_up, was_down_[i] = is_down;
      publish(i, reset.begin()[i] ? preset.begin()[i] : count.begin()[i] + step);
    }
    has_last_ = true;
    return ok();
  }

 private:
  Outcome judge() const {
    for (std::size_t i = 0; i < low.size(); ++i) {
      if (static_cast<double>(low[i]) < -kMostCount || static_cast<double>(high[i]) > kMostCount)
        return fault("low and high must be -2^53 to 2^53");
      if (low[i] > high[i]) return fault("low must be at most high");
      if (preset[i] < low[i] || preset[i] > high[i]) return fault("preset must be low to high");
    }
    return ok();
  }
  void publish(std::size_t i, std::int64_t value) {
    const std::int64_t least = low.begin()[i], most = high.begin()[i];
    if (value > most) value = *wraps ? least : most;
    if (value < least) value = *wraps ? most : least;
    count.begin()[i] = value;
    at_high.begin()[i] = value == most;
  }

  bool has_last_ = false, is_preset_ = false;
  bool was_up_[library::kMostElements] = {}, was_down_[library::kMostElements] = {};
};

CHIMERA_COMPONENT(EdgeCounter, "counter", "Counts rising edges, up and down.");

}  // namespace
