// SPDX-License-Identifier: Apache-2.0
// Builds a task set in memory from the heap.
#include "chimera/runtime/hosted/heap_task_set.h"

namespace chimera {

Result<std::unique_ptr<HeapTaskSet>> HeapTaskSet::create(const ApplicationSpec& spec,
                                                         std::span<const chimera_component* const> components,
                                                         const ContextPlace& place) {
  std::unique_ptr<HeapTaskSet> made(new HeapTaskSet(spec, place));
  if (auto built = made->build(components); !built) return built.error();
  return made;
}

}  // namespace chimera
