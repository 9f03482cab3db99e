// SPDX-License-Identifier: Apache-2.0
// For tests of signal components: a rig whose signals have one element by default.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

#include "chimera/task/rig.h"

namespace chimera {

struct SignalRig : Rig {
  explicit SignalRig(const char* component, std::uint32_t elements = 1) : Rig(component) { extent("n", elements); }

  /// Sets the input, runs a cycle and returns the output; NaN after a fault.
  double step(double x, Nanoseconds dt = milliseconds(1)) {
    set("x", x);
    return cycle(dt) ? get<double>("y") : std::nan("");
  }
  /// Gain of a linear filter at 1 kHz, by correlation over whole periods after the transient. `frequency` is a multiple
  /// of 0.25 Hz.
  double gain(double frequency) {
    constexpr int kSettle = 4000, kSamples = 4000;
    std::complex<double> sum = 0;
    for (int k = 0; k < kSettle + kSamples; ++k) {
      const double turn = 2 * std::numbers::pi * frequency * k * 1e-3, y = step(std::sin(turn));
      if (k >= kSettle) sum += y * std::polar(1.0, turn);
    }
    return std::abs(sum) * 2 / kSamples;
  }
};

}  // namespace chimera
