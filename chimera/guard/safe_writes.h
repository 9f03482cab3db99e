// SPDX-License-Identifier: Apache-2.0
// The safe frames of all tasks: the device of each, and the frames that are being written because their process is
// dead.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/platform/descriptor.h"
#include "chimera/runtime/hosted/rtpu_block.h"

namespace chimera {

/// Results of the frames of one rtpu.
struct WrittenFrames {
  std::uint32_t good = 0, bad = 0;
  std::uint32_t late = 0;  ///< not written, because the device is the successor's already
  Nanoseconds at{};  ///< when a device accepted the last byte; 0: none did
};

/// All memory is allocated at the start. Context of all functions but the constructor: any; system calls that do not
/// wait.
class SafeWrites {
 public:
  /// Context: setup.
  explicit SafeWrites(std::uint32_t n_tasks) : frames_(std::size_t{n_tasks} * kSafeFrames) {}

  /// From here on a frame of `task` goes to `descriptor`, which it owns, instead of any earlier one. A frame without a
  /// descriptor goes nowhere. An unknown task or frame is ignored.
  void keep(std::uint32_t task, std::uint32_t frame, OwnedDescriptor descriptor, Nanoseconds pause) noexcept;
  /// Begins to write the frames of `task` in `block`. Requires: its process is dead. A frame that `successor` (may be
  /// empty) has as well is left out: the successor drives the device.
  void begin(TaskId task, const BlockView& block, const BlockView& successor, Nanoseconds now) noexcept;
  /// Writes the frames that are due, as far as the devices accept them.
  void advance(Nanoseconds now) noexcept;
  /// Time when advance() is due; kNever: no frame is being written.
  Nanoseconds due() const noexcept;
  bool is_on_its_way(TaskId task) noexcept;
  /// Adds the results of the frames of the task to `written`, gives up those that wait, and closes their descriptors.
  void finish(TaskId task, WrittenFrames& written) noexcept;

 private:
  enum class Stage : std::uint8_t { kNone, kWaits, kWritten, kLost, kLate };
  struct Frame {
    OwnedDescriptor device;
    Nanoseconds pause{}, due = kNever, until = kNever, at{};
    Stage stage = Stage::kNone;
    std::uint32_t size = 0, put = 0;
    std::byte bytes[kSafeBytes];
  };
  static void write(Frame& frame, Nanoseconds now) noexcept;
  std::span<Frame> of(TaskId task) noexcept {
    return std::span(frames_).subspan(std::size_t{task.index} * kSafeFrames, kSafeFrames);
  }

  std::vector<Frame> frames_;
};

}  // namespace chimera
