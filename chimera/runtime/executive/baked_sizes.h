// SPDX-License-Identifier: Apache-2.0
// Sizes of the tables of an image in bytes on a 32-bit machine, for `chimera bake`, which runs on another one. The
// compiler of the target compares them.
#pragma once

#include <cstddef>

#include "chimera/runtime/executive/baked.h"

namespace chimera::baked {

inline constexpr std::size_t kTaskSpecBytes = 136, kPortSpecBytes = 120, kVariableBytes = 28, kPortOfBytes = 12;
inline constexpr std::size_t kConstantSpecBytes = 40, kGivenSpecBytes = 52, kNamedSetBytes = 40, kScriptActBytes = 48;
inline constexpr std::size_t kApplicationSpecBytes = 116, kTaskIdBytes = 4;
inline constexpr std::size_t kSwitchPlanBytes = 48, kHandoverBytes = 28;
inline constexpr std::size_t kLivePortBytes = 48;  ///< the live half of a port, in the state of its component

static_assert(sizeof(void*) != 4 || (sizeof(TaskSpec) == kTaskSpecBytes && sizeof(PortSpec) == kPortSpecBytes &&
                                     sizeof(Variable) == kVariableBytes && sizeof(PortOf) == kPortOfBytes));
static_assert(sizeof(void*) != 4 ||
              (sizeof(ConstantSpec) == kConstantSpecBytes && sizeof(GivenSpec) == kGivenSpecBytes &&
               sizeof(NamedSet) == kNamedSetBytes && sizeof(ScriptAct) == kScriptActBytes));
static_assert(sizeof(void*) != 4 || (sizeof(ApplicationSpec) == kApplicationSpecBytes &&
                                     sizeof(TaskId) == kTaskIdBytes && sizeof(chimera_port) == kLivePortBytes));
static_assert(sizeof(void*) != 4 || (sizeof(SwitchPlan) == kSwitchPlanBytes && sizeof(Handover) == kHandoverBytes));

}  // namespace chimera::baked
