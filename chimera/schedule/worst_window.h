// SPDX-License-Identifier: Apache-2.0
// The worst window as it would be seen: everything released at once, every job as long as it may be, in an executive
// just behind the longest job that goes last. A picture to look at, not a proof: analysis.h has that.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/work.h"

namespace chimera {

/// One task held the processor from `from` to `to`; what reaches beyond the window is cut there.
struct WindowRun {
  std::uint32_t task = 0;
  Nanoseconds from, to;
};

/// Memory for one task.
struct WindowTask {
  Nanoseconds next, release, left;
  bool is_active = false, has_started = false;
  std::uint32_t releases = 0;
};

struct WorstWindow {
  Nanoseconds length;     ///< how far it was drawn: at most as far as asked
  std::size_t runs = 0;   ///< of `runs` written
};

/// Plays `works` on `cpu` for `length`, or until `runs` is full. A late job goes on; of releases behind it the newest
/// counts. `room` is as long as `works`. Context: setup; pure.
WorstWindow worst_window(std::span<const Work> works, std::span<const ProcessorUse> uses, std::uint32_t cpu,
                         Nanoseconds length, std::span<WindowTask> room, std::span<WindowRun> runs) noexcept;

}  // namespace chimera
