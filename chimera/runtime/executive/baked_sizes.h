// SPDX-License-Identifier: Apache-2.0
// Sizes of the tables and records of an image in bytes on a 32-bit machine, for `chimera bake`, which runs on another
// one. The compiler of the target compares them, because the tables include this.
#pragma once

#include <cstddef>

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/executive/baked.h"
#include "chimera/runtime/job/job_record.h"
#include "chimera/runtime/life/task_host.h"
#include "chimera/runtime/state/task_memory.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera::baked {

inline constexpr std::size_t kTaskSpecBytes = 136, kPortSpecBytes = 120, kVariableBytes = 28, kPortOfBytes = 12;
inline constexpr std::size_t kConstantSpecBytes = 40, kGivenSpecBytes = 52, kNamedSetBytes = 40, kScriptActBytes = 48;
inline constexpr std::size_t kApplicationSpecBytes = 116, kTaskIdBytes = 4;
inline constexpr std::size_t kSwitchPlanBytes = 48, kHandoverBytes = 28;
inline constexpr std::size_t kLivePortBytes = 48;  ///< the live half of a port, in the state of its component

// In RAM, of each task. All that has a fixed size: what its job, its state and its place in the queue need.
inline constexpr std::size_t kTaskRecordBytes = 816;
inline constexpr std::size_t kSwitchRecordBytes = 336;  ///< more, in an image with switches
inline constexpr std::size_t kGroupHeadBytes = 40;      ///< of a group of values; a task has two
// Of each port, beside its live half and its values.
inline constexpr std::size_t kInputBytes = 28, kOutputBytes = 64, kConstantPortBytes = 12, kResourcePortBytes = 8;
inline constexpr std::size_t kWiredPortBytes = 8;  ///< of each declared port

/// Bytes of the records of a task on this machine. Words of lists by task count as one, and each task as a class.
constexpr std::size_t record_bytes() noexcept {
  constexpr std::size_t kListed = 8 * sizeof(bool) + 4 * sizeof(std::uint32_t) + 5 * sizeof(std::uint64_t);
  return sizeof(Task) + sizeof(TaskMemory) + sizeof(JobRecord) + sizeof(TaskHost) + sizeof(ClassMember) +
         sizeof(TaskClass) + kListed;
}
inline constexpr bool kIsImage = sizeof(void*) == 4 && !mechanisms::kCopies;
static_assert(!kIsImage || record_bytes() <= kTaskRecordBytes + (mechanisms::kSwitch ? kSwitchRecordBytes : 0));
static_assert(!kIsImage || (group_bytes(0) == kGroupHeadBytes && sizeof(WiredPort) == kWiredPortBytes &&
                            sizeof(Input) + sizeof(PortSpec*) == kInputBytes &&
                            sizeof(Output) + sizeof(chimera_inherited) == kOutputBytes &&
                            sizeof(ConstantPort) == kConstantPortBytes));
static_assert(sizeof(void*) != 4 || (sizeof(TaskSpec) == kTaskSpecBytes && sizeof(PortSpec) == kPortSpecBytes &&
                                     sizeof(Variable) == kVariableBytes && sizeof(PortOf) == kPortOfBytes));
static_assert(sizeof(void*) != 4 ||
              (sizeof(ConstantSpec) == kConstantSpecBytes && sizeof(GivenSpec) == kGivenSpecBytes &&
               sizeof(NamedSet) == kNamedSetBytes && sizeof(ScriptAct) == kScriptActBytes));
static_assert(sizeof(void*) != 4 || (sizeof(ApplicationSpec) == kApplicationSpecBytes &&
                                     sizeof(TaskId) == kTaskIdBytes && sizeof(chimera_port) == kLivePortBytes));
static_assert(sizeof(void*) != 4 || (sizeof(SwitchPlan) == kSwitchPlanBytes && sizeof(Handover) == kHandoverBytes));

}  // namespace chimera::baked
