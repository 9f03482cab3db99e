// SPDX-License-Identifier: Apache-2.0
// Position and velocity of an encoder, from two tracks or a count. README.md is the data sheet.
#include <cstring>

#include "chimera/base/message.h"
#include "chimera/base/number_text.h"
#include "chimera/task/component.h"
#include "chimera/task/number_at.h"
#include "library/encoder/wheel.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

constexpr double kMostCount = 9007199254740992.0;  // 2^53: a double represents every count up to here exactly
constexpr double kLongest = 86400;

struct Encoder {
  Many<In<Any[]>, 3> in{"in*", "1", "[n...<=64]", type = "T",
                        doc = "Tracks A and B, or a count; then the optional index."};
  InConst<double[]> span{"span", "U", "[n...<=64]", doc = "Way of `counts` counts; below 0 reverses the direction."};
  InConst<std::int64_t> counts{"counts", "1", initial = 1, range(1, kMostCount),
                               doc = "Counts in a span; tracks give four to a line."};
  InConst<std::int64_t> wrap{"wrap", "1", initial = 0, range(0, kMostCount),
                             doc = "Counts until a count repeats: 65536 of 16 bits; 0: 2^32 of int32, else none."};
  InConst<bool> is_absolute{"is_absolute", "1", initial = false,
                            doc = "At on the position is that of the count; false: it continues."};
  InConst<Text<16>> zero_at{"zero_at", "1", initial = "first",
                            doc = "Index that sets the position to 0: first (since on) or every."};
  InConst<double> window{"window", "s", initial = 0.0, range(0, kLongest),
                         doc = "Least time over which the velocity is measured."};
  InConst<double> standstill{"standstill", "s", initial = 0.1, range(1e-6, kLongest),
                             doc = "Time without a count after which the velocity is 0."};
  Out<double[]> position{"position", "U", "[n...<=64]", initial = 0.0, doc = "Position."};
  Out<double[]> velocity{"velocity", "U/s", "[n...<=64]", initial = 0.0, doc = "Velocity."};
  Out<std::int64_t[]> count{"count", "1", "[n...<=64]", initial = 0, doc = "The position in counts."};
  Out<std::int64_t[]> errors{"errors", "1", "[n...<=64]", initial = 0,
                             doc = "Cycles in which both tracks changed: too fast, or a broken wire."};
  Out<bool[]> is_referenced{"is_referenced", "1", "[n...<=64]", initial = false, doc = "The index was seen since on."};

  Outcome init() {
    const Outcome inputs = judge_inputs();
    if (!library::is_ok(inputs)) return inputs;
    for (const double way : span)
      if (!math::is_finite(way) || way == 0) return fault("span must be finite and not 0");
    if (*counts < 1 || static_cast<double>(*counts) > kMostCount) return fault("counts must be 1 to 2^53");
    if (*wrap < 0 || *wrap == 1 || static_cast<double>(*wrap) > kMostCount)
      return fault("wrap must be 2 to 2^53, or 0 for none");
    if (has_tracks_ && (*wrap != 0 || *is_absolute))
      return fault("wrap and is_absolute are for a count, not for tracks");
    if (*zero_at != "first" && *zero_at != "every") return fault("zero_at must be first or every");
    if (!(*window >= 0 && *window <= kLongest) || !(*standstill >= 1e-6 && *standstill <= kLongest))
      return fault("window must be 0 to 86400 s, and standstill 0.000001 to 86400 s");
    const bool is_small = !has_tracks_ && in[0].element_type() == CHIMERA_INT32;
    wrap_ = *wrap == 0 && is_small ? std::uint64_t{1} << 32 : static_cast<std::uint64_t>(*wrap);
    window_ = nanoseconds_of(*window);
    standstill_ = nanoseconds_of(*standstill);
    return ok();
  }
  Outcome reinit() { return init(); }
  // Continues from the last count. The reference is lost, because turns while the task was off are not seen.
  void on() {
    for (std::size_t i = 0; i < count.size(); ++i) {
      axis_[i].wheel.begin(count[i]);
      axis_[i].zero = 0;
      velocity[i] = 0;
      is_referenced[i] = false;
    }
  }
  Outcome cycle(Cycle c) {
    for (const auto& port : in)
      if (!port.valid()) return aborted();
    const Outcome numbers = has_tracks_ ? ok() : read_counts();
    if (!library::is_ok(numbers)) return numbers;
    for (std::size_t i = 0; i < count.size(); ++i) see(i, c.now());
    return ok();
  }
  bool error() { return true; }

 private:
  struct Axis {
    library::CountedWheel wheel;
    std::int64_t found = 0;  // count of this cycle
    std::int64_t zero = 0;   // total for which the count is 0
    bool was_index = false;
  };

  static Nanoseconds nanoseconds_of(double seconds) {
    return Nanoseconds{static_cast<std::int64_t>(math::floor(seconds * 1e9 + 0.5))};
  }
  bool is_bool(std::size_t k) const { return in[k].element_type() == CHIMERA_BOOL; }
  Outcome judge_inputs() {
    if (in.size() == 0) return fault("name the tracks A and B, or a count");
    if (in[0].element_type() > CHIMERA_FLOAT64) return fault("in[0] is a track or a count, no text and no struct");
    has_tracks_ = is_bool(0);
    const std::size_t tracks = has_tracks_ ? 2 : 1;
    if (in.size() < tracks) return fault("in[0] is the track A: name the track B, too");
    if (in.size() > tracks + 1) return fault("behind a count there is an index and nothing else");
    for (std::size_t k = 1; k < in.size(); ++k)
      if (!is_bool(k)) return fault("behind in[0] there are truth values: the track B, or the index");
    has_index_ = in.size() > tracks;
    return ok();
  }
  bool truth(std::size_t k, std::size_t i) const { return in[k].bytes()[i] != std::byte{0}; }
  /// Reads all counts before it uses one, so that a fault leaves all axes at the same cycle.
  Outcome read_counts() {
    const std::span<const std::byte> bytes = in[0].bytes();
    const std::uint32_t type = in[0].element_type();
    for (std::size_t i = 0; i < count.size(); ++i) {
      const std::byte* at = bytes.data() + i * in[0].element_size();
      if (type == CHIMERA_INT64) {
        std::memcpy(&axis_[i].found, at, sizeof axis_[i].found);
        continue;
      }
      const double number = number_at(type, at);
      if (!(math::fabs(number) <= kMostCount))
        return fault((Message("in[0][") << i << "] is " << number_text(number, 9).view()
                                        << ": a count is finite and at most 2^53").view());
      axis_[i].found = static_cast<std::int64_t>(math::floor(number + 0.5));
    }
    return ok();
  }
  void see(std::size_t i, Nanoseconds now) {
    Axis& axis = axis_[i];
    const bool is_first = !axis.wheel.has_last();
    if (has_tracks_) {
      if (!axis.wheel.see(truth(0, i), truth(1, i), now, window_, standstill_)) errors.begin()[i] += 1;
    } else {
      if (is_first && *is_absolute) axis.wheel.begin(axis.found);
      axis.wheel.see(axis.found, wrap_, now, window_, standstill_);
    }
    if (has_index_) meet_index(i, is_first);
    const std::int64_t place = axis.wheel.total() - axis.zero;
    const double way = span.begin()[i] / static_cast<double>(*counts);
    count.begin()[i] = place;
    position.begin()[i] = static_cast<double>(place) * way;
    velocity.begin()[i] = axis.wheel.velocity() * way;
  }
  void meet_index(std::size_t i, bool is_first) {
    Axis& axis = axis_[i];
    const bool is_index = truth(in.size() - 1, i);
    bool& has_met = is_referenced.begin()[i];
    if (is_index && !axis.was_index && !is_first && (!has_met || *zero_at == "every")) {
      axis.zero = axis.wheel.total();
      has_met = true;
    }
    axis.was_index = is_index;
  }

  bool has_tracks_ = false, has_index_ = false;
  std::uint64_t wrap_ = 0;
  Nanoseconds window_, standstill_;
  Axis axis_[library::kMostElements];
};

CHIMERA_COMPONENT(Encoder, "encoder", "Position and velocity from two tracks, or from a count that wraps.",
                  rate = 1000.0);

}  // namespace
