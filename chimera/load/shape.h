// SPDX-License-Identifier: Apache-2.0
// The shape of a port as text: "" scalar, "[6]", "[ndof<=10]", "[3][3]"; "[n...<=64]" takes any shape of its variable.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"

namespace chimera {

inline constexpr std::uint32_t kMaxExtent = 65'536;  ///< of one dimension, and of the whole shape

/// One dimension: a literal (`symbol` empty), or a constant or extent variable with a maximum. If it stands alone, it
/// may be a shape variable: any number of dimensions, together `max` elements.
struct Extent {
  std::string symbol;
  std::uint32_t max = 1;
  bool is_shape = false;

  bool is_literal() const noexcept { return symbol.empty(); }
  bool operator==(const Extent&) const = default;
};

/// The dimensions of `text`, none for a scalar. Accepts one or two of `[literal]` or `[symbol<=literal]`, or one
/// `[symbol...<=literal]`, of 1..kMaxExtent. Refuses all others, with the text found. Context: setup; may block.
Result<std::vector<Extent>> parse_shape(std::string_view text);

/// Product of the maxima; 1 for a scalar. Context: any; wait-free.
std::uint32_t max_count(std::span<const Extent> extents) noexcept;

}  // namespace chimera
