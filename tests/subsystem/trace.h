// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <string_view>

#include "chimera/base/time.h"

namespace chimera::simulated {

/// Everything that happens, in one number: the same seed gives the same. Printed too when asked for.
class Trace {
 public:
  explicit Trace(bool prints) noexcept : prints_(prints) {}

  void note(Nanoseconds now, std::string_view what, std::initializer_list<std::int64_t> values = {},
            std::string_view text = "") {
    mix(static_cast<std::uint64_t>(now.count));
    for (char c : what) mix(static_cast<unsigned char>(c));
    for (std::int64_t value : values) mix(static_cast<std::uint64_t>(value));
    for (char c : text) mix(static_cast<unsigned char>(c));
    if (!prints_) return;
    std::printf("%12.6f %.*s", to_seconds(now), static_cast<int>(what.size()), what.data());
    for (std::int64_t value : values) std::printf(" %lld", static_cast<long long>(value));
    if (!text.empty()) std::printf(" %.*s", static_cast<int>(text.size()), text.data());
    std::printf("\n");
  }
  std::uint64_t hash() const noexcept { return hash_; }

 private:
  void mix(std::uint64_t value) noexcept { hash_ = (hash_ ^ value) * 0x100000001b3u; }  // FNV-1a, a word at a time

  std::uint64_t hash_ = 0xcbf29ce484222325u;
  bool prints_ = false;
};

}  // namespace chimera::simulated
