// SPDX-License-Identifier: Apache-2.0
// Test signals: sine, square, triangle, sawtooth, chirp, noise, step. README.md is the data sheet.
#include <string_view>

#include "chimera/task/component.h"
#include "library/signals/fade.h"
#include "library/signals/input.h"
#include "library/signals/waveform.h"

using namespace chimera;

namespace {

struct SignalGenerator {
  InConst<Text<16>>     wave{"wave", "1", initial = "sine",
                             one_of = "sine square triangle sawtooth chirp noise step", doc = "Kind of signal."};
  InConst<double[]>     amplitude{"amplitude", "U", "[n...<=64]",
                                  doc = "From the middle to the peak."};
  InConst<double[]>     offset{"offset", "U", "[n...<=64]", initial = 0.0, doc = "The middle."};
  InConst<double>       frequency{"frequency", "Hz", initial = 1.0, range(0, 1e6),
                                  doc = "Frequency of the wave; start of a chirp."};
  InConst<double[]>     phase{"phase", "rad", "[n...<=64]", initial = 0.0, doc = "Phase at the start."};
  InConst<double>       end_frequency{"end_frequency", "Hz", initial = 10.0, range(0, 1e6), doc = "End of a chirp."};
  InConst<double>       duration{"duration", "s", initial = 10.0, range(1e-6, 86400), doc = "Duration of a chirp."};
  InConst<double>       delay{"delay", "s", initial = 0.0, range(0, 86400), doc = "Time before the wave or the step."};
  InConst<std::int64_t> seed{"seed", "1", initial = 1, doc = "Equal seeds give equal noise."};
  Many<In<double[]>, 1> start{"start*", "U", "[n...<=64]", doc = "Measured value of y, for on; may be left out."};
  InConst<double>       blend{"blend", "s", initial = 1.0, range(0, 3600),
                              doc = "Time in which the way from start to the wave fades; 0: a jump."};
  Out<double[]>         y{"y", "U", "[n...<=64]", doc = "offset + amplitude times the wave."};

  Outcome init() {
    if (!library::find_waveform(wave->view(), wave_))
      return fault("wave must be sine, square, triangle, sawtooth, chirp, noise or step");
    if (!library::all_finite(amplitude) || !library::all_finite(offset) || !library::all_finite(phase))
      return fault("amplitude, offset and phase must be finite");
    if (!is_within(*frequency, 0, 1e6) || !is_within(*end_frequency, 0, 1e6))
      return fault("frequencies must be 0 to 1000000 Hz");
    if (!is_within(*duration, 1e-6, 86400) || !is_within(*delay, 0, 86400))
      return fault("duration must be 0.000001 to 86400 s, and delay 0 to 86400 s");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() { begin(y.is_handed_over()); }
  // A machine that holds itself under the flag does not follow: the wave waits, then starts where the machine is.
  void cycle(Cycle c) {
    const bool waits = c.illegal() && start.size() > 0;
    if (!waits && stood_) return begin(false);
    stood_ = waits;
    if (waits) return;
    elapsed_ += c.step();
    fade_.advance(c.dt());
    publish();
  }

 private:
  static bool is_within(double value, double least, double most) { return value >= least && value <= most; }
  /// From an output that is handed over, else from `start`, else from the wave.
  void begin(bool goes_on) {
    elapsed_ = {};
    stood_ = false;
    noise_ = library::Noise(static_cast<std::uint64_t>(*seed));
    const bool is_measured = start.size() > 0 && library::all_finite(start[0]);
    const bool has_start = is_measured || (start.size() > 0 && goes_on && library::all_finite(y));
    for (std::size_t i = 0; has_start && i < y.size(); ++i)
      away_[i] = goes_on && library::all_finite(y) ? y[i] : start[0][i];
    fade_.start(0);
    publish();
    if (!has_start || !(*blend > 0)) return;
    fade_.start(*blend);
    for (std::size_t i = 0; i < y.size(); ++i) {
      away_[i] -= y[i];
      y[i] += away_[i];
    }
  }
  void publish() {
    const double left = fade_.left();
    const double t = to_seconds(elapsed_) - *delay;
    const double turns = wave_ == library::Waveform::kChirp
                             ? library::chirp_turns(t, *frequency, *end_frequency, *duration) : *frequency * t;
    for (std::size_t i = 0; i < y.size(); ++i) {
      double value = 0;
      if (t >= 0) {
        value = wave_ == library::Waveform::kNoise
                    ? noise_.next() : library::waveform(wave_, turns + phase.begin()[i] / (2 * math::kPi));
      }
      y.begin()[i] = offset.begin()[i] + amplitude.begin()[i] * value;
      if (left > 0) y.begin()[i] += left * away_[i];
    }
  }

  library::Waveform wave_ = library::Waveform::kSine;
  library::Noise noise_{1};
  Nanoseconds elapsed_;  // whole nanoseconds lose no phase in a year
  library::Fade fade_;
  double away_[library::kMostElements] = {};  // the way from the wave to the start
  bool stood_ = false;                        // the flag was up in the last cycle
};

CHIMERA_COMPONENT(SignalGenerator, "signal_generator",
                  "Test signals: sine, square, triangle, sawtooth, chirp, noise, step.",
                  rate = 1000.0);

}  // namespace
