// SPDX-License-Identifier: Apache-2.0
// Reads the state of rtpus, alive or dead, for the orders of switches.
#include "chimera/manager/switch/switch_members.h"

namespace chimera::manager {

std::uint16_t ShownMembers::living() const noexcept {
  std::uint32_t living = 0;
  for (std::uint32_t r = 0; r < state_.peers.n_rtpus(); ++r)
    if (state_.rtpus[r].is_alive) living |= 1u << r;
  return static_cast<std::uint16_t>(living);
}

// A task of a dead rtpu, or one whose `init` or `kill` runs, cannot take part in a switch.
TaskStatus ShownMembers::status(TaskId task) const noexcept {
  const bool is_alive = state_.rtpus[state_.spec().tasks[task.index].rtpu.index].is_alive;
  const State state = state_.state(task);
  const bool is_lost = !is_alive && state != State::kNotCreated;
  return {is_lost ? State::kError : state, !is_alive || state_.peers.status(task).in_service};
}

bool ShownMembers::needs_gaps(TaskId task) const noexcept {
  const RtpuId rtpu = state_.spec().tasks[task.index].rtpu;
  return state_.peers.of(task).is_there() && !state_.spec().rtpus[rtpu.index].preemptive;
}

bool ShownMembers::is_busy_with(std::uint32_t context, std::uint16_t plan) const noexcept {
  if (context >= state_.peers.n_rtpus() || !state_.rtpus[context].is_alive) return false;
  if (!state_.peers[RtpuId(context)].is_there()) return false;
  const SwitchProgress& progress = state_.peers[RtpuId(context)].block().head().switching;
  return progress.over.load(std::memory_order_acquire) != plan;  // SwitchProgress
}

bool ShownMembers::read_part(std::uint32_t context, std::uint16_t plan, SwitchReceipt& part) const noexcept {
  if (context >= state_.peers.n_rtpus() || !state_.peers[RtpuId(context)].is_there()) return false;
  const SwitchPart& there = state_.peers[RtpuId(context)].block().switch_part();
  if (there.number != plan) return false;
  chimera::read_part(there, part);
  return true;
}

bool ShownMembers::differ(ConstantId constant, std::uint32_t a, std::uint32_t b) const noexcept {
  const std::vector<std::byte> one = value(constant, a), other = value(constant, b);
  return one.empty() || one != other;
}

// The constant as the rtpu of its producer publishes it; empty if there is no value.
std::vector<std::byte> ShownMembers::value(ConstantId constant, std::uint32_t producer) const {
  const TaskId task = state_.spec().constants[constant.index].producers[producer].task;
  const PeerLayout& layout = state_.peers.layout(state_.spec().tasks[task.index].rtpu);
  const GroupId group = layout.constants(task);
  if (!state_.peers.of(task).is_there()) return {};
  std::vector<std::byte> payload(layout.place(group).payload_bytes);
  chimera_slot slot;
  const GroupReader reader = state_.peers.of(task).group(group);
  if (!reader.is_bound() || !reader.try_read(slot, payload.data()) || slot.sequence == 0) return {};
  std::size_t i = 0;
  for (const PortSpec& port : state_.spec().tasks[task.index].ports) {
    if (port.kind != CHIMERA_OUT_CONST) continue;
    const std::byte* const at = payload.data() + layout.variables(group)[i++].offset;
    if (port.constant == constant) return {at, at + port.max_bytes()};
  }
  return {};
}

}  // namespace chimera::manager
