// SPDX-License-Identifier: Apache-2.0
// Values that a safety port refuses: NaN, infinity, or a value outside its declared range.
#pragma once

#include "chimera/task/task.h"

namespace chimera {

/// True when every staged value of the task's safety ports may be published. Otherwise `text` (of
/// CHIMERA_FAULT_TEXT bytes) names the first port, element and value. Context: cycle; wait-free; O(safety values).
bool is_safe(const Task& task, char* text) noexcept;

}  // namespace chimera
