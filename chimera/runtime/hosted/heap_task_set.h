// SPDX-License-Identifier: Apache-2.0
// A task set together with the heap memory that it and its executors work in.
#pragma once

#include <memory>
#include <span>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/life/task_set.h"

namespace chimera {

/// Given back after the set that works in it.
struct TaskSetHeap {
  HeapMemory heap;
};

/// Context of making and unmaking: setup.
class HeapTaskSet final : private TaskSetHeap, public TaskSet {
 public:
  /// As TaskSet::build().
  static Result<std::unique_ptr<HeapTaskSet>> create(const ApplicationSpec& spec,
                                                     std::span<const chimera_component* const> components,
                                                     const ContextPlace& place = {}) {
    std::unique_ptr<HeapTaskSet> made(new HeapTaskSet(spec, place));
    if (auto built = made->build(components); !built) return built.error();
    return made;
  }

 private:
  HeapTaskSet(const ApplicationSpec& spec, const ContextPlace& place) : TaskSet(spec, place, heap) {}
};

}  // namespace chimera
