// SPDX-License-Identifier: Apache-2.0
// Whether the tasks of a context live: the decision of the watchdog.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/setup_memory.h"
#include "chimera/base/time.h"
#include "chimera/task/task.h"
#include "firmware/watch/stack.h"

namespace chimera::firmware {

/// Why the watchdog is not stroked.
enum class VitalFault : std::uint8_t {
  kNone,
  kSilent,    ///< `task` is ON and completed no cycle in its last two periods
  kUnheard,   ///< an event of the aperiodic `task`, which is ON, waits for longer than two of its periods
  kCritical,  ///< `task`, of criticality high, is in ERROR
  kGuard,     ///< the guard of stack number `stack` is overwritten
};

inline constexpr const char* kVitalWords[] = {"healthy", "silent", "unheard event", "critical error", "stack guard"};

/// "silent" for kSilent. Context: any; wait-free.
constexpr const char* vital_word(VitalFault fault) noexcept {
  return kVitalWords[static_cast<std::uint8_t>(fault)];
}

/// One answer of the decision.
struct VitalAnswer {
  VitalFault fault = VitalFault::kNone;
  TaskId task;              ///< of kSilent, kUnheard, kCritical: the first by number
  std::uint32_t stack = 0;  ///< of kGuard

  bool is_healthy() const noexcept { return fault == VitalFault::kNone; }
};

/// TaskSpec::criticality from which on ERROR of a task ends the strokes.
inline constexpr std::uint32_t kHighCriticality = 2;

/// Remembers, by task, the last sign of life. Sees it only when asked: a completed cycle counts from the look that
/// found it, so a task is called silent up to one tick late, and never early.
class Vitals {
 public:
  /// All outlive this. Takes 16 bytes for each task. Context: setup.
  Vitals(std::span<const Task> tasks, std::span<const Stack> stacks, SetupMemory& memory)
      : tasks_(tasks), stacks_(stacks), seen_(memory.take<Seen>(tasks.size())) {}

  /// Call it once a tick. Context: between jobs; wait-free; O(tasks).
  VitalAnswer look(Nanoseconds now) noexcept;

 private:
  struct Seen {
    Nanoseconds alive;  // at the last look that found a completed cycle, no waiting event, or the task not ON
    std::uint32_t cycles = 0;
  };

  VitalFault judge(const Task& task, Seen& seen, Nanoseconds now) noexcept;

  std::span<const Task> tasks_;
  std::span<const Stack> stacks_;
  std::span<Seen> seen_;  // by task
};

}  // namespace chimera::firmware
