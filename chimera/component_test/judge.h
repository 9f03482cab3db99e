// SPDX-License-Identifier: Apache-2.0
// The judgements on a component: one line each.
#pragma once

#include <string>
#include <vector>

#include "chimera/component_test/trial.h"

namespace chimera::component_test {

enum class Finding : std::uint8_t { kOk, kFails, kNotJudged };

struct JudgedProperty {
  std::string name;  ///< "outputs"
  Finding verdict = Finding::kOk;
  std::string text;  ///< one sentence without a full stop
};

/// A measurement without a judgement.
struct Measured {
  std::size_t cycles = 0;
  double typical_ns = 0;      ///< mean of the middle half: finer than the clock
  std::int64_t worst_ns = 0;  ///< of the least of three times of each cycle
};

struct TrialReport {
  std::string component;
  std::string inputs;  ///< the source of the inputs
  std::vector<JudgedProperty> judgements;
  Measured measured;

  bool passes() const noexcept;
};

/// Data for the judgements beside the trial.
struct Circumstances {
  const Descriptor& component;
  const Configuration& configuration;
  const Inputs& inputs;
  bool has_partner = false;
};

/// Makes all judgements; each appears once, in a fixed order. Context: setup.
TrialReport judge(const Trial& trial, const Circumstances& about);

/// "signal 11 (Segmentation fault) in cycle 17"; "" if the scenario reached its end. Context: setup.
std::string how_it_ended(const PlayEnd& end, const Record& record);

}  // namespace chimera::component_test
