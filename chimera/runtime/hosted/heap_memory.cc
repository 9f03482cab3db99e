// SPDX-License-Identifier: Apache-2.0
// Takes pieces from the heap, and leaves them there where a thread may still be in them.
#include "chimera/runtime/hosted/heap_memory.h"

#include <utility>

namespace chimera {
namespace {

// Memory that is never freed, kept reachable for leak detectors.
struct NeverFreed {
  std::mutex mutex;
  std::vector<std::vector<AlignedBytes>> pieces;
};

NeverFreed& never_freed() {
  static auto& all = *new NeverFreed;
  return all;
}

}  // namespace

HeapMemory::~HeapMemory() {
  if (!is_kept_) return;
  const std::lock_guard lock(never_freed().mutex);
  never_freed().pieces.push_back(std::move(pieces_));
}

std::span<std::byte> HeapMemory::take_bytes(std::size_t size, std::size_t alignment) {
  const std::lock_guard lock(mutex_);
  return pieces_.emplace_back(size, alignment).span();
}

void HeapMemory::keep_for_ever() noexcept {
  const std::lock_guard lock(mutex_);
  is_kept_ = true;
}

}  // namespace chimera
