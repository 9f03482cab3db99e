// SPDX-License-Identifier: Apache-2.0
// Tells a thread, without a system call, whether it kept its processor for a while: then the clock on the wall says
// how long it computed, more exactly than the clock of its execution time, whose reading is a system call.
//
//   begin() | computes | end(): true when nothing came between
//
// It rests on restartable sequences: whenever the kernel takes the processor from a thread, or hands it a signal, it
// clears the sequence that the thread has named, unless the thread stands in it (linux/rseq.h, `rseq_cs`). Named here
// is a sequence of no instructions. Code in between that uses such sequences itself is taken for a switch.
#pragma once

namespace chimera {

/// Of the calling thread; not nested.
class SwitchWatch {
 public:
  /// Whether this system can tell. Tried once, by falling asleep. Context: setup; blocks for some microseconds.
  static bool can_tell() noexcept;
  /// From here on. Requires: can_tell(). Context: cycle; wait-free.
  static void begin() noexcept;
  /// True when the thread was neither preempted nor asleep since begin(), and no signal came. Context: cycle;
  /// wait-free.
  static bool end() noexcept;
};

}  // namespace chimera
