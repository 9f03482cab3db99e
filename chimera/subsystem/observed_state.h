// SPDX-License-Identifier: Apache-2.0
// The last known state of the processes and their tasks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/hosted/rtpu_block.h"

namespace chimera::subsystem {

enum class RtpuLife : std::uint8_t {
  kUnknown,   ///< may live, does not serve this manager yet
  kUp,
  kStarting,  ///< dead; its start was requested
  kDown       ///< dead; no start was requested
};

/// Context: setup.
class ObservedState {
 public:
  explicit ObservedState(const ApplicationSpec& spec)
      : spec_(spec), tasks_(spec.tasks.size()), rtpus_(spec.rtpus.size()) {}

  void see(TaskId task, TaskStatus status) noexcept;
  /// First start of the subsystem: no task is there.
  void begin_empty() noexcept;
  void up(RtpuId rtpu, std::uint32_t incarnation) noexcept;
  /// The process is dead: its tasks are gone, and those that were created are lost.
  void down(RtpuId rtpu, std::uint32_t incarnation) noexcept;
  void starting(RtpuId rtpu, Nanoseconds now) noexcept;
  /// A lost task that is no longer wanted becomes NOT-CREATED.
  void forget(TaskId task) noexcept { tasks_[task.index].is_lost = false; }
  /// `wanted`: at the death of its process no `kill` of the task had been requested and its `init` was not the cause.
  void want_back(TaskId task, bool wanted) noexcept { tasks_[task.index].is_wanted = wanted; }
  bool is_wanted_back(TaskId task) const noexcept { return is_lost(task) && tasks_[task.index].is_wanted; }

  /// State as users see it: a lost task is in ERROR.
  State state(TaskId task) const noexcept;
  /// Status of the task in the live process, or the last one of a process whose death is not known yet.
  const TaskStatus& status(TaskId task) const noexcept { return tasks_[task.index].status; }
  bool is_lost(TaskId task) const noexcept { return tasks_[task.index].is_lost; }
  /// True if the state of the task is known.
  bool is_seen(TaskId task) const noexcept { return tasks_[task.index].is_seen; }
  bool is_created(TaskId task) const noexcept { return status(task).state != State::kNotCreated; }
  RtpuLife life(RtpuId rtpu) const noexcept { return rtpus_[rtpu.index].life; }
  RtpuLife life_of(TaskId task) const noexcept { return life(rtpu(task)); }
  std::uint32_t incarnation(RtpuId rtpu) const noexcept { return rtpus_[rtpu.index].incarnation; }
  /// Time since when the rtpu is awaited.
  Nanoseconds since(RtpuId rtpu) const noexcept { return rtpus_[rtpu.index].since; }
  /// Instants of its last restarts, 0: none.
  std::array<Nanoseconds, 4>& restarts(RtpuId rtpu) noexcept { return rtpus_[rtpu.index].restarts; }
  RtpuId rtpu(TaskId task) const noexcept { return spec_.tasks[task.index].rtpu; }

 private:
  struct Task {
    TaskStatus status;
    bool is_lost = false;
    bool is_wanted = false;
    bool is_seen = false;
  };
  struct Rtpu {
    RtpuLife life = RtpuLife::kUnknown;
    std::uint32_t incarnation = 0;
    Nanoseconds since;
    std::array<Nanoseconds, 4> restarts{};
  };
  const ApplicationSpec& spec_;
  std::vector<Task> tasks_;
  std::vector<Rtpu> rtpus_;
};

}  // namespace chimera::subsystem
