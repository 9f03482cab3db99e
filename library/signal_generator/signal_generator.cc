// SPDX-License-Identifier: Apache-2.0
// Test signals: sine, square, triangle, sawtooth, chirp, noise, step. README.md is the data sheet.
#include <string_view>

#include "chimera/task/component.h"
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
  void on() {
    elapsed_ = {};
    noise_ = library::Noise(static_cast<std::uint64_t>(*seed));
    publish();
  }
  void cycle(Cycle c) {
    elapsed_ += c.step();
    publish();
  }

 private:
  static bool is_within(double value, double least, double most) { return value >= least && value <= most; }
  void publish() {
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
    }
  }

  library::Waveform wave_ = library::Waveform::kSine;
  library::Noise noise_{1};
  Nanoseconds elapsed_;  // whole nanoseconds lose no phase in a year
};

CHIMERA_COMPONENT(SignalGenerator, "signal_generator",
                  "Test signals: sine, square, triangle, sawtooth, chirp, noise, step.",
                  rate = 1000.0);

}  // namespace
