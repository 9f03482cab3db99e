// SPDX-License-Identifier: Apache-2.0
// Tells by a restartable sequence (rseq) of the kernel whether a thread was taken off its processor.
#include "chimera/platform/switch_watch.h"

#include <sys/rseq.h>

#include <cstdint>
#include <ctime>

namespace chimera {
namespace {

// Where an interrupted sequence would be taken up, behind the signature that the kernel wants. Nobody goes there.
const std::uint32_t nowhere[2] = {RSEQ_SIG, 0};

std::uint64_t address(const void* p) noexcept { return reinterpret_cast<std::uintptr_t>(p); }

rseq_cs empty_sequence() noexcept {
  rseq_cs sequence{};
  sequence.start_ip = sequence.abort_ip = address(&nowhere[1]);
  return sequence;
}

const rseq_cs sequence = empty_sequence();

// The word that the kernel clears, of the calling thread; the C library has registered it.
volatile __u64& word() noexcept {
  char* const thread = static_cast<char*>(__builtin_thread_pointer());
  return reinterpret_cast<rseq*>(thread + __rseq_offset)->rseq_cs;
}

// A kernel may be without them, or may look at the word only when it returns from an interrupt.
bool sees_a_sleep() noexcept {
  if (__rseq_size == 0) return false;
  SwitchWatch::begin();
  const timespec shortly{0, 1'000};
  ::clock_nanosleep(CLOCK_MONOTONIC, 0, &shortly, nullptr);
  return !SwitchWatch::end();
}

}  // namespace

bool SwitchWatch::can_tell() noexcept {
  static const bool can = sees_a_sleep();
  return can;
}

void SwitchWatch::begin() noexcept { word() = address(&sequence); }

bool SwitchWatch::end() noexcept {
  const bool kept = word() == address(&sequence);
  word() = 0;
  return kept;
}

}  // namespace chimera
