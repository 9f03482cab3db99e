// SPDX-License-Identifier: Apache-2.0
// Tasks that one thread passes to another. Each task is in the queue at most once, so the queue never overflows.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "chimera/base/ids.h"

namespace chimera {

class TaskQueue {
 public:
  /// For tasks 0 to n_tasks - 1. Context: setup.
  explicit TaskQueue(std::size_t n_tasks) : tasks_(n_tasks + 1) {}

  /// Requires: the task is not in the queue. Context: any, the one writer; wait-free.
  void push(TaskId task) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    tasks_[head % tasks_.size()] = task;
    head_.store(head + 1, std::memory_order_release);  // pairs with pop(): the entry is complete
  }
  /// False if the queue is empty. Context: any, the one reader; wait-free.
  bool pop(TaskId& task) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    task = tasks_[tail % tasks_.size()];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::vector<TaskId> tasks_;
  alignas(64) std::atomic<std::size_t> head_{0};  // store-release by push() pairs with the acquire of pop()
  alignas(64) std::atomic<std::size_t> tail_{0};  // used by the reader alone: pairs with nothing
};

}  // namespace chimera
