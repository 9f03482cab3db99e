// SPDX-License-Identifier: Apache-2.0
// A whole application as handed down to the runtime. Made by Configuration::spec(), or baked into an image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/schedule/policy.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// A value that the description itself produces: a constant, or an operator variable's initial value.
struct GivenSpec {
  std::string_view name;
  std::uint32_t type = CHIMERA_FLOAT64;
  std::uint32_t element_bytes = 8;
  ExtentSpec extent[CHIMERA_MAX_EXTENTS];
  std::span<const std::byte> value;  ///< extent[0].max * extent[1].max elements
  std::uint32_t listed[CHIMERA_MAX_EXTENTS] = {};  ///< as PortSpec::listed
};

/// A real-time processing unit.
struct RtpuSpec {
  std::string_view name;
  std::uint32_t cpu = 0;
  Policy policy = Policy::kEdf;
  bool preemptive = false;  ///< a thread for each task; else one loop, the executive
};

/// Context: setup. Every span must outlive the runtime that is made from it.
struct ApplicationSpec {
  std::string_view name;
  std::span<const RtpuSpec> rtpus;
  std::span<const TaskSpec> tasks;
  std::span<const GivenSpec> constants;
  std::span<const GivenSpec> operators;
  std::span<const TaskId> init_order;  ///< every task, producers of constants before their users
  std::span<const TaskId> start;       ///< the tasks that go ON, in data-flow order, hardware inputs first
};

}  // namespace chimera
