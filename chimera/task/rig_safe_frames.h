// SPDX-License-Identifier: Apache-2.0
// Part of rig.h: the safe frames of the component under test.
#pragma once

#include <cstdint>
#include <cstring>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"

namespace chimera {

/// The frames that would be written if the process died now. Context: any; wait-free.
class RigSafeFrames {
 public:
  struct GivenFrame {
    int descriptor = -1;  ///< below 0: no destination
    Nanoseconds pause;
    std::uint32_t size = 0;  ///< 0: no frame
    unsigned char bytes[CHIMERA_SAFE_BYTES];
  };
  /// Requires: index < CHIMERA_SAFE_FRAMES.
  const GivenFrame& safe_frame(std::uint32_t index) const noexcept { return frames_[index]; }

 protected:
  std::int32_t keep(std::uint32_t index, int descriptor, Nanoseconds pause) noexcept {
    if (index >= CHIMERA_SAFE_FRAMES) return CHIMERA_FAULT;
    frames_[index].descriptor = descriptor;
    frames_[index].pause = pause;
    return CHIMERA_OK;
  }
  std::int32_t put(std::uint32_t index, const void* bytes, std::uint32_t size) noexcept {
    if (index >= CHIMERA_SAFE_FRAMES || size > CHIMERA_SAFE_BYTES) return CHIMERA_FAULT;
    frames_[index].size = size;
    if (size != 0) std::memcpy(frames_[index].bytes, bytes, size);
    return CHIMERA_OK;
  }
  // For chimera_host, whose context is the whole rig.
  template <class Whole>
  static std::int32_t host_safe_frame(void* rig, std::uint32_t index, std::int32_t descriptor, std::int64_t pause) {
    return static_cast<Whole*>(rig)->keep(index, descriptor, {pause});
  }
  template <class Whole>
  static std::int32_t host_safe_bytes(void* rig, std::uint32_t index, const void* bytes, std::uint32_t size) {
    return static_cast<Whole*>(rig)->put(index, bytes, size);
  }
  void take_back() noexcept {
    for (GivenFrame& frame : frames_) frame.size = 0;
  }

 private:
  GivenFrame frames_[CHIMERA_SAFE_FRAMES];
};

}  // namespace chimera
