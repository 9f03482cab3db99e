// SPDX-License-Identifier: Apache-2.0
// The producers and consumers of every variable and constant, collected from the ids that ports carry. The ids are the
// one record of a link: verification writes them, an image carries them, and this list cannot contradict them.
#pragma once

#include <span>
#include <vector>

#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Owns the lists that Variable and ConstantSpec point at. Movable; spans stay valid. Context: setup.
class Links {
 public:
  /// Reads the ports of `tasks` and fills producers, consumers and operator_index of `variables`, and producers of
  /// `constants`. Requires: every valid id of a port or an operator lies within these lists.
  void fill(std::span<const TaskSpec> tasks, std::span<const GivenSpec> operators, std::span<Variable> variables,
            std::span<ConstantSpec> constants);

 private:
  std::vector<PortOf> ports_;
};

}  // namespace chimera
