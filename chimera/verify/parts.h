// SPDX-License-Identifier: Apache-2.0
// What a Configuration holds. Filled once by verify(), then never moved or changed: spec() points into it.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "chimera/runtime/hosted/links.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/model.h"

namespace chimera {

struct Configuration::Parts {
  Draft draft;
  std::vector<ConfiguredTask> tasks;
  std::vector<ConfiguredVariable> variables;
  std::vector<ConfiguredSet> sets;
  std::size_t start = 0;
  std::vector<double> utilisation;
  // What spec() points at. Elements of a deque stay where they are.
  std::deque<std::string> texts;
  std::deque<std::vector<std::byte>> values;
  std::vector<RtpuSpec> rtpus;
  std::vector<std::vector<PortSpec>> ports;
  std::vector<TaskSpec> task_specs;
  std::vector<Variable> state_variables;
  std::vector<std::size_t> configured;  // index in `variables`, by VariableId
  std::vector<ConstantSpec> constants;
  std::vector<GivenSpec> operators;
  Links links;
  std::vector<TaskId> init_order, on_order, end_order;
  std::vector<NamedSet> named_sets;
  ApplicationSpec spec;
};

/// The parts of a model without faults. Context: setup.
std::shared_ptr<const Configuration::Parts> make_parts(const Model& model);
/// The half that the runtime reads; `parts` has its tasks already. Context: setup.
void fill_spec(const Model& model, Configuration::Parts& parts);

}  // namespace chimera
