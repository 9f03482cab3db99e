// SPDX-License-Identifier: Apache-2.0
// For tests: tasks of 10 ms without ports, with the records and the tap that parts of the runtime work on.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/job/job_record.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera::testing {

inline constexpr TaskId kFirst{0u}, kSecond{1u};

/// Two tasks that are ON; what their method error answers. Everything recorded on the tap is kept.
struct BareTasks {
  BareTasks() {
    component.methods[CHIMERA_ERROR] = [](void* instance, const chimera_call*) -> std::int32_t {
      return static_cast<BareTasks*>(instance)->recovers ? CHIMERA_OK : CHIMERA_FAULT;
    };
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      specs[i].name = i == 0 ? "first" : "second";
      specs[i].period = specs[i].deadline = milliseconds(10);
      tasks[i].id = TaskId(i);
      tasks[i].spec = &specs[i];
      tasks[i].component = &component;
      tasks[i].instance = this;
      tasks[i].state = State::kOn;
      tasks[i].group = GroupWriter(memory[i].bytes, 16);
      records[i].task = &tasks[i];
      records[i].start_margin = Nanoseconds{INT64_MIN / 2};
      records[i].budget = kNever;
    }
  }
  Task& first() { return tasks[0]; }
  /// The job of the task that is released at `release_ms`.
  static Job job(TaskId task, std::int64_t release_ms) {
    return {task, milliseconds(release_ms), milliseconds(release_ms + 10)};
  }
  bool leaves(JobRecord::Left what, TaskId task = kFirst) const { return (records[task.index].left & what) != 0; }
  /// The kinds of the records since the last call.
  std::vector<TapKind> recorded() {
    std::vector<TapRecord> all(kTapRecords);
    all.resize(reader.read(all));
    std::vector<TapKind> kinds;
    for (const TapRecord& one : all) kinds.push_back(one.kind);
    return kinds;
  }

  struct alignas(64) Memory {
    std::array<std::byte, group_bytes(16)> bytes{};
  };
  bool recovers = true;
  chimera_component component{};
  std::array<TaskSpec, 2> specs;
  std::array<Task, 2> tasks;
  std::array<JobRecord, 2> records;
  std::array<Memory, 2> memory;
  std::unique_ptr<TapRing> ring = std::make_unique<TapRing>();
  Tap tap{*ring};
  TapReader reader{*ring};
  HeapMemory heap;
  ContextTap context_tap{tasks, &tap, 0, false, heap};
  ModelledClock clock;
};

}  // namespace chimera::testing
