// SPDX-License-Identifier: Apache-2.0
// The words for a criticality.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace chimera {

/// Index: TaskSpec::criticality.
inline constexpr std::array<std::string_view, 3> kCriticalities = {"low", "medium", "high"};

/// The word of `criticality`; values above the highest count as the highest. Context: any.
constexpr const char* criticality_name(std::uint32_t criticality) noexcept {
  return kCriticalities[criticality < kCriticalities.size() ? criticality : kCriticalities.size() - 1].data();
}

}  // namespace chimera
