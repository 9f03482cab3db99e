// SPDX-License-Identifier: Apache-2.0
// Sends the rtpu's memory and the descriptors of its devices to the guard.
#include "chimera/rtpu/guard_link.h"

#include "chimera/platform/descriptor.h"

namespace chimera {
namespace {

constexpr Nanoseconds kGuardReadLimit = milliseconds(500);  // ample: the highest priority lets the guard read at once

}  // namespace

void GuardLink::show(int segment, const BlockOwner& block) noexcept {
  block_ = block;
  // If the message cannot be sent, the rtpu runs as without a guard.
  (void)send({.kind = GuardMessage::Kind::kSegment}, segment);
}

bool GuardLink::keep(TaskId task, std::uint32_t index, int descriptor, Nanoseconds pause) noexcept {
  return send({.kind = GuardMessage::Kind::kFrame, .task = task.index, .frame = index, .pause = pause}, descriptor);
}

bool GuardLink::send(GuardMessage message, int passed) noexcept {
  message.index = peer_;
  message.incarnation = incarnation_;
  if (line_.send(bytes_of(message), passed)) return true;
  Watched room{.descriptor = line_.descriptor(), .for_room = true};
  return await_ready({&room, 1}, kGuardReadLimit) > 0 && line_.send(bytes_of(message), passed);
}

}  // namespace chimera
