// SPDX-License-Identifier: Apache-2.0
// The safe frames of all tasks: where each goes, and those that are on their way because their process is dead.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/platform/descriptor.h"
#include "chimera/runtime/hosted/rtpu_block.h"

namespace chimera {

/// What became of the frames of one unit.
struct WrittenFrames {
  std::uint32_t good = 0, bad = 0;
  Nanoseconds at{};  ///< when the last byte was taken; 0: none was
};

/// The memory is made at once; from then on nothing is asked of the heap. Context of all but the constructor: any;
/// system calls that do not wait.
class SafeWrites {
 public:
  /// Context: setup.
  explicit SafeWrites(std::uint32_t n_tasks) : frames_(std::size_t{n_tasks} * kSafeFrames) {}

  /// A frame of `task` goes to `descriptor`, which it owns from here on, in place of any before; one without a
  /// descriptor goes nowhere. What does not exist is passed over.
  void keep(std::uint32_t task, std::uint32_t frame, OwnedDescriptor descriptor, Nanoseconds pause) noexcept;
  /// Begins with those of `task` that stand in `block`: its process is dead.
  void begin(TaskId task, const BlockView& block, Nanoseconds now) noexcept;
  /// Writes what is due, as far as the devices take it.
  void advance(Nanoseconds now) noexcept;
  /// When advance() is due; kNever: nothing is on its way.
  Nanoseconds due() const noexcept;
  bool is_on_its_way(TaskId task) noexcept;
  /// What became of the frames of the task is added to `written`; their descriptors are closed.
  void finish(TaskId task, WrittenFrames& written) noexcept;

 private:
  enum class Stage : std::uint8_t { kNone, kWaits, kWritten, kLost };
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
