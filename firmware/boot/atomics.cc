// SPDX-License-Identifier: Apache-2.0
// Atomic operations that the processor does not have: of 64 bits, and on ARMv6-M also read-modify-write of 32 bits.
// One processor runs the image, so it is enough that no interrupt comes between.
#include <cstdint>

#include "chimera/platform/bare/core.h"

namespace chimera::firmware {
namespace {

template <class Word>
Word exchange(volatile void* at, Word value) noexcept {
  const bare::NoInterrupts off;
  auto& word = *static_cast<volatile Word*>(at);
  const Word before = word;
  word = value;
  return before;
}

template <class Word, class Change>
Word update(volatile void* at, Change change) noexcept {
  const bare::NoInterrupts off;
  auto& word = *static_cast<volatile Word*>(at);
  const Word before = word;
  word = change(before);
  return before;
}

template <class Word>
bool compare_exchange(volatile void* at, void* expected, Word desired) noexcept {
  const bare::NoInterrupts off;
  auto& word = *static_cast<volatile Word*>(at);
  auto& wanted = *static_cast<Word*>(expected);
  const Word before = word;
  if (before == wanted) return word = desired, true;
  wanted = before;
  return false;
}

}  // namespace

// The names are those that the compiler calls. An asm label gives them, because they are built into it.
#define CHIMERA_ATOMICS(bytes, Word)                                                                             \
  extern "C" Word atomic_load_##bytes(const volatile void* at, int) asm("__atomic_load_" #bytes);                \
  Word atomic_load_##bytes(const volatile void* at, int) {                                                       \
    const bare::NoInterrupts off;                                                                                \
    return *static_cast<const volatile Word*>(at);                                                               \
  }                                                                                                              \
  extern "C" void atomic_store_##bytes(volatile void* at, Word value, int) asm("__atomic_store_" #bytes);        \
  void atomic_store_##bytes(volatile void* at, Word value, int) { exchange<Word>(at, value); }                   \
  extern "C" Word atomic_exchange_##bytes(volatile void* at, Word value, int) asm("__atomic_exchange_" #bytes);  \
  Word atomic_exchange_##bytes(volatile void* at, Word value, int) { return exchange<Word>(at, value); }         \
  extern "C" bool atomic_compare_exchange_##bytes(volatile void*, void*, Word, int, int) asm(                    \
      "__atomic_compare_exchange_" #bytes);                                                                      \
  bool atomic_compare_exchange_##bytes(volatile void* at, void* expected, Word desired, int, int) {              \
    return compare_exchange<Word>(at, expected, desired);                                                        \
  }                                                                                                              \
  CHIMERA_FETCH(bytes, Word, add, before + value)                                                                \
  CHIMERA_FETCH(bytes, Word, sub, before - value)                                                                \
  CHIMERA_FETCH(bytes, Word, or, before | value)                                                                 \
  CHIMERA_FETCH(bytes, Word, and, before & value)
#define CHIMERA_FETCH(bytes, Word, name, after)                                                                  \
  extern "C" Word atomic_fetch_##name##_##bytes(volatile void* at, Word, int) asm("__atomic_fetch_" #name "_" #bytes); \
  Word atomic_fetch_##name##_##bytes(volatile void* at, Word value, int) {                                       \
    return update<Word>(at, [value](Word before) { return after; });                                             \
  }

CHIMERA_ATOMICS(8, std::uint64_t)
#ifndef __ARM_FEATURE_LDREX
CHIMERA_ATOMICS(4, std::uint32_t)
CHIMERA_ATOMICS(1, std::uint8_t)
#endif

#undef CHIMERA_ATOMICS
#undef CHIMERA_FETCH

}  // namespace chimera::firmware
