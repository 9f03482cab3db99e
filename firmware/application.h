// SPDX-License-Identifier: Apache-2.0
// The baked application on the chip, with everything that serves it. docs/formats/image_output.md.
#pragma once

#include <cstddef>
#include <new>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/executive/executive.h"
#include "firmware/digest_lines.h"
#include "firmware/event_interrupts.h"
#include "firmware/idle_clock.h"
#include "firmware/method_clock.h"
#include "firmware/receipt_lines.h"

namespace chimera::firmware {

/// Lives as long as the image, as all its parts do. Context of everything: setup.
class Image {
 public:
  /// Takes the parts from `memory`. `boot` is how the image began; it outlives this.
  Image(std::span<std::byte> memory, const Boot& boot) noexcept
      : memory_(memory, stop_ram_too_small), memory_bytes_(memory.size()), boot_(boot) {}
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  /// Makes and starts the tasks, runs until the duration is over, and prints the results. Returns an exit code: 0 is
  /// success.
  int run();

 private:
  template <class T, class... Arguments>
  T& make(Arguments&&... arguments) {
    return *::new (memory_.take_bytes(sizeof(T), alignof(T)).data()) T(static_cast<Arguments&&>(arguments)...);
  }
  static void stop_ram_too_small(std::size_t bytes) noexcept;
  void make_executive();
  bool start();
  int end(RunEnd end);

  GivenMemory memory_;
  std::size_t memory_bytes_;
  const Boot& boot_;
  IdleWork served_;
  // Null until they are made.
  TaskSet* set_ = nullptr;
  IdleClock* clock_ = nullptr;
  MethodClock* method_clock_ = nullptr;
  Digest* digest_ = nullptr;
  ReceiptLinesOut* receipts_ = nullptr;
  Executive* executive_ = nullptr;
};

}  // namespace chimera::firmware
