// SPDX-License-Identifier: Apache-2.0
// How large the stacks of the threads are that are started while it lives.
#pragma once

#include <cstddef>

namespace chimera {

/// Sets the default of the process and gives the one before back. One at a time. Context: setup.
class ThreadStack {
 public:
  /// `bytes` 0: as it is.
  explicit ThreadStack(std::size_t bytes) noexcept;
  ThreadStack(const ThreadStack&) = delete;
  ThreadStack& operator=(const ThreadStack&) = delete;
  ~ThreadStack();

 private:
  std::size_t before_ = 0;
};

}  // namespace chimera
