// SPDX-License-Identifier: Apache-2.0
// Copies bytes and the counter of a group from one context to another (docs/decisions/0001-register-copy.md). The
// register has two builds:
//
//   release    memcpy copies, with a size that the compiler cannot know. The bytes race with the
//              writer; the counter check discards a torn copy. Two fences order copy and counter.
//   word-wise  (CHIMERA_WORDWISE_COPY=1, thread sanitizer) each 8-byte word is an atomic: release
//              stores, acquire loads, no fence, because the sanitizer does not model fences.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "chimera/table/slot_header.h"

#ifndef CHIMERA_WORDWISE_COPY
#define CHIMERA_WORDWISE_COPY 0
#endif

namespace chimera::shared_copy {

/// The counter word at `place`. Readers use it on read-only mappings and never store through it. group.h names the
/// pairs of loads and stores.
inline std::atomic_ref<std::uint64_t> word(const std::byte* place) noexcept {
  return std::atomic_ref<std::uint64_t>(*reinterpret_cast<std::uint64_t*>(const_cast<std::byte*>(place)));
}

/// The header of a slot, in both builds word by word: three moves; the reserved word stays zero. A header that is built
/// on the stack and copied as a block would be read with wider loads than its stores, which stalls.
inline void store_header(std::byte* to, const chimera_slot& header) noexcept {
  constexpr auto order = CHIMERA_WORDWISE_COPY ? std::memory_order_release : std::memory_order_relaxed;
  word(to).store(static_cast<std::uint64_t>(header.published_ns), order);
  word(to + 8).store(header.sequence, order);
  word(to + 16).store(header.valid, order);
}
inline void load_header(chimera_slot& header, const std::byte* from) noexcept {
  constexpr auto order = CHIMERA_WORDWISE_COPY ? std::memory_order_acquire : std::memory_order_relaxed;
  header.published_ns = static_cast<std::int64_t>(word(from).load(order));
  header.sequence = word(from + 8).load(order);
  header.valid = word(from + 16).load(order);
  header.reserved = 0;
}

#if CHIMERA_WORDWISE_COPY

inline void release_fence() noexcept {}  // every word is stored with release
inline void acquire_fence() noexcept {}  // every word is loaded with acquire

inline std::atomic_ref<unsigned char> byte_at(const std::byte* place) noexcept {
  return std::atomic_ref<unsigned char>(*reinterpret_cast<unsigned char*>(const_cast<std::byte*>(place)));
}

/// Unseen by the sanitizer: a writer that overtakes this copy stages its next values as plain words, and the check of
/// the counter discards the copy.
__attribute__((no_sanitize("thread"), noinline)) inline void copy_out(void* to, const std::byte* from,
                                                                       std::size_t bytes) noexcept {
  auto* out = static_cast<unsigned char*>(to);
  const auto* in = reinterpret_cast<const unsigned char*>(from);
  std::size_t i = 0;
  for (; i + 8 <= bytes; i += 8) {
    const auto w = __atomic_load_n(reinterpret_cast<const std::uint64_t*>(in + i), __ATOMIC_ACQUIRE);
    std::memcpy(out + i, &w, 8);
  }
  for (; i < bytes; ++i) out[i] = __atomic_load_n(in + i, __ATOMIC_ACQUIRE);
}

inline void copy_in(std::byte* to, const void* from, std::size_t bytes) noexcept {
  const auto* in = static_cast<const unsigned char*>(from);
  std::size_t i = 0;
  for (; i + 8 <= bytes; i += 8) {
    std::uint64_t w;
    std::memcpy(&w, in + i, 8);
    word(to + i).store(w, std::memory_order_release);
  }
  for (; i < bytes; ++i) byte_at(to + i).store(in[i], std::memory_order_release);
}

inline void move_inside(std::byte* to, const std::byte* from, std::size_t bytes) noexcept {
  std::size_t i = 0;
  for (; i + 8 <= bytes; i += 8) word(to + i).store(word(from + i).load(std::memory_order_relaxed),
                                                    std::memory_order_release);
  for (; i < bytes; ++i) byte_at(to + i).store(byte_at(from + i).load(std::memory_order_relaxed),
                                               std::memory_order_release);
}

#else

inline void release_fence() noexcept { std::atomic_thread_fence(std::memory_order_release); }
inline void acquire_fence() noexcept { std::atomic_thread_fence(std::memory_order_acquire); }

/// memcpy with a size hidden from the compiler: a known size would be expanded to `rep movsq`, three times slower.
inline void opaque_copy(void* to, const void* from, std::size_t bytes) noexcept {
  if (bytes == 0) return;  // a group without variables has no values, and possibly no memory for them
  asm volatile("" : "+r"(bytes));
  std::memcpy(to, from, bytes);
}
/// From the register into private memory.
inline void copy_out(void* to, const std::byte* from, std::size_t bytes) noexcept { opaque_copy(to, from, bytes); }
/// From private memory into the register.
inline void copy_in(std::byte* to, const void* from, std::size_t bytes) noexcept { opaque_copy(to, from, bytes); }
/// Copies from one slot to another, `bytes` behind the header; only the writer calls it. A slot is whole cache lines
/// and its header 32 bytes, so blocks of 32 bytes stay inside it. A few blocks cost less than a call of memcpy.
inline void move_inside(std::byte* to, const std::byte* from, std::size_t bytes) noexcept {
  constexpr std::size_t kBlock = 32, kCallBeyond = 256;
  if (bytes > kCallBeyond) return opaque_copy(to, from, bytes);
  for (const std::byte* end = from + bytes; from < end; from += kBlock, to += kBlock) {
    std::memcpy(to, from, kBlock);
    asm volatile("" : "+r"(from), "+r"(to));  // keeps the compiler from turning the loop into a call
  }
}

#endif

}  // namespace chimera::shared_copy
