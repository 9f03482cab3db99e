// SPDX-License-Identifier: Apache-2.0
// Defines the functions of the heap again, and forwards them to glibc under its second names. The dynamic linker binds
// every shared object to the definition in the program.
#include "chimera/platform/allocation_count.h"

#include <atomic>
#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__)
// <sanitizer/allocator_interface.h> is missing on some machines that have the sanitizer.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*, std::size_t),
                                                         void (*free_hook)(const volatile void*));
#endif

namespace chimera {
namespace {

// Relaxed, pair with nothing: a reader reads its own figures, or those of joined threads.
std::atomic<bool> is_watched{false};
std::atomic<std::int64_t> live{0};
thread_local std::uint64_t here = 0;

[[maybe_unused]] void note_allocation() noexcept {
  if (!is_watched.load(std::memory_order_relaxed)) return;
  ++here;
  live.fetch_add(1, std::memory_order_relaxed);
}
[[maybe_unused]] void note_free() noexcept {
  if (is_watched.load(std::memory_order_relaxed)) live.fetch_sub(1, std::memory_order_relaxed);
}

}  // namespace

void watch_allocations() noexcept {
#if defined(__SANITIZE_ADDRESS__)
  if (!is_watched.load(std::memory_order_relaxed))
    (void)__sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { note_allocation(); },
                                                    [](const volatile void* block) {
                                                      if (block != nullptr) note_free();
                                                    });
#endif
  is_watched.store(true, std::memory_order_relaxed);
}

std::uint64_t allocations_of_this_thread() noexcept { return here; }
std::int64_t live_allocations() noexcept { return live.load(std::memory_order_relaxed); }

}  // namespace chimera

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {

// NOLINTBEGIN(bugprone-reserved-identifier): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  chimera::note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  chimera::note_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  chimera::note_allocation();
  if (block != nullptr) chimera::note_free();
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  chimera::note_allocation();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  chimera::note_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  chimera::note_allocation();
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) noexcept {
  if (block != nullptr) chimera::note_free();
  __libc_free(block);
}

}  // extern "C"
#endif
