// SPDX-License-Identifier: Apache-2.0
// Generated and spoilt rows. base/math.h does all arithmetic, so that a seed gives the same bytes on every machine.
#include <algorithm>
#include <cstring>
#include <limits>

#include "chimera/base/math.h"
#include "chimera/component_test/inputs.h"
#include "chimera/component_test/record.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera::component_test {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr std::size_t kHold = 20;  // cycles that a step or an end of the range lasts
constexpr std::size_t kParts = 5;  // waves, steps, noise, ends, waves

double uniform(std::uint64_t seed, std::uint64_t channel, std::uint64_t n) {
  return static_cast<double>(mixed(seed, channel, n) >> 11) * 0x1p-53;
}

// The place of the channel in its range at cycle i of n, from 0 to 1.
double place(std::uint64_t seed, std::size_t channel, std::size_t i, std::size_t n) {
  const std::size_t length = n / kParts + 1, part = i / length;
  const std::uint64_t held = 1'000'000 + i / kHold;
  switch (part) {
    case 1:
      return uniform(seed, channel, held);
    case 2:
      return uniform(seed, channel, i);
    case 3:
      return uniform(seed, channel, held) < 0.5 ? 0 : 1;
    default: {
      const double turns = 0.3 + 2.7 * uniform(seed, channel, 2'000'000), phase = uniform(seed, channel, 2'000'001);
      const double at = static_cast<double>(i % length) / static_cast<double>(length);
      return 0.5 + 0.5 * math::sin(kTwoPi * (turns * at + phase));
    }
  }
}

void make_unit(std::byte* quaternion) {
  double q[4];
  std::memcpy(q, quaternion, sizeof q);
  const double length = math::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (length < 1e-3)
    q[0] = 1, q[1] = q[2] = q[3] = 0;
  else
    for (double& part : q) part /= length;
  std::memcpy(quaternion, q, sizeof q);
}

}  // namespace

Inputs Inputs::generated(const InputForm& form, std::uint64_t seed, std::size_t rows) {
  Inputs made(rows, form.bytes());
  for (std::size_t i = 0; i < rows; ++i) {
    const std::span<std::byte> row = made.writable(i);
    std::ranges::copy(form.base, row.begin());
    for (std::size_t c = 0; c < form.channels.size(); ++c) {
      const InputChannel& channel = form.channels[c];
      form.put(channel, channel.low + (channel.high - channel.low) * place(seed, c, i, rows), row);
    }
    for (const std::size_t at : form.quaternions) make_unit(row.data() + at);
  }
  return made;
}

bool spoil(const InputForm& form, std::size_t kind, std::span<std::byte> row) noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bool is_spoilt = false;
  for (const InputChannel& channel : form.channels) {
    const bool is_float = channel.type >= CHIMERA_FLOAT32;
    const bool is_whole = channel.type == CHIMERA_INT32 || channel.type == CHIMERA_INT64;
    const bool is_ranged = math::is_finite(channel.declared_high);
    double value = 0;
    if (kind == 0 && is_float)
      value = std::numeric_limits<double>::quiet_NaN();
    else if (kind == 1 && is_float)
      value = kInfinity;
    else if ((kind == 2 && is_float) || (kind == 4 && is_whole))
      value = -kInfinity;
    else if (kind == 3 && is_ranged)
      value = channel.high + 10 * (channel.high - channel.low) + 1;
    else
      continue;
    form.put(channel, value, row);
    is_spoilt = true;
  }
  return is_spoilt;
}

const char* spoilt_name(std::size_t kind) noexcept {
  constexpr const char* kNames[kBadInputs] = {"NaN", "infinity", "-infinity", "beyond the range",
                                              "the least whole numbers"};
  return kNames[kind];
}

}  // namespace chimera::component_test
