// SPDX-License-Identifier: Apache-2.0
// A random application for the simulation: 20 to 28 tasks on 4 rtpus, alternatives, loops, constants.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "chimera/runtime/testing/named_links.h"
#include "tests/subsystem/chance.h"

namespace chimera::simulated {

/// Owns what `spec` points at. Every state variable has one producer in the start set; some have a second one outside.
class Plan {
 public:
  static constexpr std::size_t kRtpus = 4;

  explicit Plan(Chance& chance);
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  ApplicationSpec spec;
  /// `spec` without state variables, so that every set of tasks is legal.
  ApplicationSpec blind;

 private:
  std::string_view name(std::string text);
  void add_port(std::size_t task, std::uint32_t kind, std::string_view variable);
  void add_primaries(Chance& chance, std::size_t n);
  void add_alternatives(Chance& chance, std::size_t n);
  void add_constants(Chance& chance);
  void finish();

  std::deque<std::string> names_;
  std::vector<RtpuSpec> rtpus_;
  std::vector<TaskSpec> tasks_;
  std::vector<TaskSpec> blind_tasks_;
  std::vector<std::vector<PortSpec>> ports_;
  std::vector<std::vector<PortSpec>> blind_ports_;
  std::vector<TaskId> init_order_;
  std::vector<TaskId> start_;
  chimera::NamedLinks links_;
};

}  // namespace chimera::simulated
