// SPDX-License-Identifier: Apache-2.0
// The application as an image gets it: the verified one with the resource texts of the target.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "chimera/analysis/recorded_profile.h"
#include "chimera/bake/plans.h"
#include "chimera/bake/target.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/cycle/script.h"
#include "chimera/verify/configuration.h"

namespace chimera::bake {

/// Context: setup. Its spec lives as long as it does.
class BakedApplication {
 public:
  /// Budgets of the description belong to another machine. They stay only with a profile, which is of the target.
  BakedApplication(const Configuration& configuration, const Target& target, const RecordedProfile* profile);
  BakedApplication(const BakedApplication&) = delete;
  BakedApplication& operator=(const BakedApplication&) = delete;

  /// No task goes ON by itself: the other side of a link asks for each.
  void start_nothing() noexcept { spec_.start = {}; }

  const ApplicationSpec& spec() const noexcept { return spec_; }
  /// Acts of the description with values as large as the image has room for.
  std::vector<ScriptAct> acts(std::span<const ScriptAct> acts) const;
  const Configuration& configuration() const noexcept { return configuration_; }

 private:
  Configuration configuration_;
  std::deque<std::vector<std::byte>> texts_;
  std::vector<std::vector<PortSpec>> ports_;
  std::vector<TaskSpec> tasks_;
  std::vector<GivenSpec> operators_;
  std::vector<ConstantSpec> constants_;
  ApplicationSpec spec_;
  std::optional<BakedPlans> plans_;
};

/// "pedal" of "pedal[1]", an instance of a repeated port. Context: setup.
std::string declared_name(const ConfiguredPort& port);

}  // namespace chimera::bake
