// SPDX-License-Identifier: Apache-2.0
// Publications of the trials of this folder. Each word depends on its writer and its publication, so that a reader sees
// whether a publication is whole.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "chimera/table/slot.h"

namespace chimera {

constexpr std::uint32_t kTrialPayload = 4096;
constexpr std::size_t kTrialWords = kTrialPayload / 8;
using TrialWords = std::array<std::uint64_t, kTrialWords>;

inline std::uint64_t word_of(std::uint64_t writer, std::uint64_t publication, std::size_t i) {
  return (publication * 0x9e3779b97f4a7c15u) ^ (i * 0xc2b2ae3d27d4eb4fu) ^ (writer << 60);
}

inline void fill(std::byte* place, std::uint64_t writer, std::uint64_t publication) {
  auto* words = reinterpret_cast<volatile std::uint64_t*>(place);
  for (std::size_t i = 0; i < kTrialWords; ++i) words[i] = word_of(writer, publication, i);
}

/// True if one publication wrote header and words. A group that was never written has zero words.
inline bool is_whole(const chimera_slot& header, const TrialWords& words, std::uint64_t writer) {
  if (header.published_ns != static_cast<std::int64_t>(header.sequence)) return false;
  for (std::size_t i = 0; i < kTrialWords; ++i)
    if (words[i] != (header.sequence == 0 ? 0 : word_of(writer, header.sequence, i))) return false;
  return true;
}

}  // namespace chimera
