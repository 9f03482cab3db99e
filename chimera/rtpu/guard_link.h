// SPDX-License-Identifier: Apache-2.0
// The line from an rtpu to the guard, which writes to the devices when the rtpu is dead.
#pragma once

#include "chimera/platform/local_socket.h"
#include "chimera/rtpu/guard_message.h"
#include "chimera/runtime/hosted/rtpu_block.h"
#include "chimera/runtime/safe_frame.h"

namespace chimera {

/// Messages on the line outlive the rtpu: the guard reads them before it writes. Any thread of the rtpu.
class GuardLink final : public SafeFrames {
 public:
  /// Takes ownership of the rtpu's end of the line; below 0: there is no guard. Context: setup.
  GuardLink(int descriptor, std::uint32_t peer, std::uint32_t incarnation) noexcept
      : line_(descriptor), peer_(peer), incarnation_(incarnation) {}

  bool is_there() const noexcept { return line_.is_open(); }
  /// Shows the guard the memory that holds the frames of this rtpu. Call it before the first task is made. Context:
  /// setup.
  void show(int segment, const BlockOwner& block) noexcept;

  std::span<SafeFrame, kSafeFrames> of(TaskId task) noexcept override { return block_.safe_frames(task); }
  bool keep(TaskId task, std::uint32_t index, int descriptor, Nanoseconds pause) noexcept override;

 private:
  bool send(GuardMessage message, int passed) noexcept;

  const Channel line_;
  const std::uint32_t peer_, incarnation_;
  BlockOwner block_;
};

}  // namespace chimera
