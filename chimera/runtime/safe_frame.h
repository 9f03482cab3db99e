// SPDX-License-Identifier: Apache-2.0
// The frame that is written to a device when the process that drives it is dead: docs/design/guard.md.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "chimera/base/assert.h"
#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/task/abi.h"

namespace chimera {

inline constexpr std::uint32_t kSafeFrames = CHIMERA_SAFE_FRAMES;  ///< of a task
inline constexpr std::uint32_t kSafeBytes = CHIMERA_SAFE_BYTES;    ///< of a frame

/// The bytes of one frame, in memory that others map. One writer; read when the writer is proved dead, as its last
/// words: the buffer that the word names is whole, whatever instruction was the last one. Zeroed memory is no frame.
class SafeFrame {
 public:
  /// The frame from now on; no bytes: there is none. Requires: at most kSafeBytes. Context: cycle; wait-free.
  void put(std::span<const std::byte> bytes) noexcept {
    CHIMERA_ASSERT(bytes.size() <= kSafeBytes);
    const std::uint32_t buffer = (word_.load(std::memory_order_relaxed) & 1u) ^ 1u;
    if (!bytes.empty()) std::memcpy(buffers_[buffer], bytes.data(), bytes.size());
    const auto size = static_cast<std::uint32_t>(bytes.size());
    // SYNC: pairs with the acquire in last_words(): the buffer is whole before it is named.
    word_.store(size << 1 | buffer, std::memory_order_release);
  }
  /// Empty: there is none. Requires: the writer is dead, or is the caller, or the bytes are not read. Context: any;
  /// wait-free.
  std::span<const std::byte> last_words() const noexcept {
    const std::uint32_t word = word_.load(std::memory_order_acquire);
    const std::uint32_t size = word >> 1;
    return {buffers_[word & 1u], size <= kSafeBytes ? size : 0};
  }

 private:
  std::atomic<std::uint32_t> word_{0};  // bit 0: the buffer; above: its bytes
  std::byte buffers_[2][kSafeBytes];
};

/// The safe frames of a context: their bytes, and the keeper of the descriptors that they go to.
class SafeFrames {
 public:
  /// The frames of a task of the context. Context: any; wait-free.
  virtual std::span<SafeFrame, kSafeFrames> of(TaskId task) noexcept = 0;
  /// Hands on a copy of `descriptor` (below 0: the frame is given up). False if no process takes it. Requires: index <
  /// kSafeFrames. Context: setup; may block.
  virtual bool keep(TaskId task, std::uint32_t index, int descriptor, Nanoseconds pause) noexcept = 0;

  /// The device of the task is safe: nothing is to be written any more. Context: cycle; wait-free.
  void take_back(TaskId task) noexcept {
    for (SafeFrame& frame : of(task)) frame.put({});
  }

 protected:
  ~SafeFrames() = default;
};

}  // namespace chimera
