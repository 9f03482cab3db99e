// SPDX-License-Identifier: Apache-2.0
// Memory for setup from the heap: each piece for itself, given back with its owner.
#pragma once

#include <mutex>
#include <vector>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/hosted/aligned_bytes.h"

namespace chimera {

/// Context: setup; may block. Any thread: where a component hangs, a service thread may take memory for its successor.
class HeapMemory final : public SetupMemory {
 public:
  HeapMemory() = default;
  HeapMemory(const HeapMemory&) = delete;
  HeapMemory& operator=(const HeapMemory&) = delete;
  ~HeapMemory();

  std::span<std::byte> take_bytes(std::size_t size, std::size_t alignment) override;
  void keep_for_ever() noexcept override;

 private:
  std::mutex mutex_;
  std::vector<AlignedBytes> pieces_;
  bool is_kept_ = false;
};

}  // namespace chimera
