// SPDX-License-Identifier: Apache-2.0
// Periodic waves of amplitude 1, the phase of a chirp, and repeatable noise.
#pragma once

#include <cstdint>
#include <string_view>

#include "chimera/base/math.h"

namespace chimera::library {

enum class Waveform { kSine, kSquare, kTriangle, kSawtooth, kChirp, kNoise, kStep };

/// Returns false if no wave has that name. Context: any; wait-free.
inline bool find_waveform(std::string_view name, Waveform& found) noexcept {
  constexpr std::string_view kNames[] = {"sine", "square", "triangle", "sawtooth", "chirp", "noise", "step"};
  for (int i = 0; i < 7; ++i)
    if (name == kNames[i]) return found = static_cast<Waveform>(i), true;
  return false;
}

/// Value in [-1, 1] after `turns` turns. All waves but the step (1) and the square begin at 0 and rise. A chirp is a
/// sine of the turns that chirp_turns() gives. Context: cycle; wait-free.
inline double waveform(Waveform wave, double turns) noexcept {
  const double u = turns - math::floor(turns);  // [0, 1)
  switch (wave) {
    case Waveform::kSquare: return u < 0.5 ? 1 : -1;
    case Waveform::kTriangle: return u < 0.25 ? 4 * u : u < 0.75 ? 2 - 4 * u : 4 * u - 4;
    case Waveform::kSawtooth: return u < 0.5 ? 2 * u : 2 * u - 2;
    case Waveform::kStep: return 1;
    default: return math::sin(2 * math::kPi * u);
  }
}

/// Turns of a sine whose frequency changes linearly from `from` to `to` (Hz) in `duration` seconds and then starts
/// again. Requires: duration > 0. Context: cycle; wait-free.
inline double chirp_turns(double t, double from, double to, double duration) noexcept {
  const double since = t - duration * math::floor(t / duration);
  return since * (from + (to - from) * since / (2 * duration));
}

/// White noise, uniform over [-1, 1): a counter through the finaliser of splitmix64 (Steele, Lea and Flood, Fast
/// splittable pseudorandom number generators, 2014). Context: cycle; wait-free.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) noexcept : state_(seed) {}
  double next() noexcept {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return static_cast<double>(z >> 11) * 0x1p-52 - 1;
  }

 private:
  std::uint64_t state_;
};

}  // namespace chimera::library
