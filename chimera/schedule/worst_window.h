// SPDX-License-Identifier: Apache-2.0
// Shows the worst window: all tasks are released at once, every job uses its whole time. In an executive, the longest
// last-ranked job has just begun. It is a picture, not a proof; analysis.h has the proof.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/work.h"

namespace chimera {

/// One task ran from `from` to `to`. A run that goes beyond the window is cut at its end.
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
  Nanoseconds length;     ///< length of the window drawn: at most the requested length
  std::size_t runs = 0;   ///< number of `runs` written
};

/// Simulates `works` on `cpu` for `length`, or until `runs` is full. A late job continues; of the releases behind it
/// only the newest counts. `room` is as long as `works`. Context: setup; pure.
WorstWindow worst_window(std::span<const Work> works, std::span<const ProcessorUse> uses, std::uint32_t cpu,
                         Nanoseconds length, std::span<WindowTask> room, std::span<WindowRun> runs) noexcept;

}  // namespace chimera
