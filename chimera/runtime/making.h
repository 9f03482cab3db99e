// SPDX-License-Identifier: Apache-2.0
// The step that runs a component's code before its task exists, as a word for the process that finds this one dead: the
// shared object is loaded, or the state is constructed.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "chimera/runtime/task_word.h"

namespace chimera {

enum class Making : std::uint32_t { kNothing, kLoads, kConstructs };

/// From here on `what` is done for the task of that index. Relaxed, pairs with nothing: another process reads the cell
/// when it finds this one dead or hanging. Context: setup; wait-free.
inline void show_making(std::atomic<std::uint32_t>& cell, std::size_t task, Making what) noexcept {
  cell.store(TaskWord(TaskId(task), static_cast<std::uint32_t>(what)).word(), std::memory_order_relaxed);
}
/// From here on nothing is made. Context: setup; wait-free.
inline void show_made(std::atomic<std::uint32_t>& cell) noexcept { cell.store(0, std::memory_order_relaxed); }

/// The index of the task in `word`; UINT32_MAX for a word that show_making() never writes.
inline std::uint32_t task_of_making(std::uint32_t word, std::size_t n_tasks) noexcept {
  const std::uint32_t task = TaskWord::found(word).task().index, what = TaskWord::found(word).what();
  const bool is_known = what == static_cast<std::uint32_t>(Making::kLoads) ||
                        what == static_cast<std::uint32_t>(Making::kConstructs);
  return is_known && task < n_tasks ? task : UINT32_MAX;
}

}  // namespace chimera
