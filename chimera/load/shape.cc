// SPDX-License-Identifier: Apache-2.0
// Reads the text of a shape.
#include "chimera/load/shape.h"

#include <charconv>

#include "chimera/load/descriptor.h"

namespace chimera {
namespace {

Error refused(std::string_view shape, std::string_view why) {
  const std::string text = "shape \"" + std::string(shape) + "\": " + std::string(why);
  return {ErrorCode::kBadInput, std::string_view(text), {}};
}

/// The number, or 0 when the text is not one in 1..kMaxExtent.
std::uint32_t number(std::string_view text) {
  std::uint32_t n = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), n);
  return code == std::errc() && end == text.data() + text.size() && n <= kMaxExtent ? n : 0;
}

Result<Extent> parse_extent(std::string_view shape, std::string_view inner) {
  const auto bound = inner.find("<=");
  std::string_view symbol = bound == std::string_view::npos ? std::string_view() : inner.substr(0, bound);
  const bool is_shape = symbol.ends_with("...");
  if (is_shape) symbol.remove_suffix(3);
  const std::string_view literal = bound == std::string_view::npos ? inner : inner.substr(bound + 2);
  if (bound != std::string_view::npos && !is_identifier(symbol)) {
    return refused(shape, "\"" + std::string(symbol) + "\" is no name: [a-z][a-z0-9_]*");
  }
  if (symbol.empty() && is_identifier(literal)) {
    return refused(shape, "the extent " + std::string(literal) + " needs a maximum, as in [" +
                              std::string(literal) + "<=16]");
  }
  const std::uint32_t max = number(literal);
  if (max == 0) return refused(shape, "\"" + std::string(literal) + "\" is no whole number from 1 to 65536");
  return Extent{std::string(symbol), max, is_shape};
}

}  // namespace

Result<std::vector<Extent>> parse_shape(std::string_view text) {
  std::vector<Extent> extents;
  std::string_view rest = text;
  while (!rest.empty()) {
    const auto close = rest.find(']');
    if (rest.front() != '[' || close == std::string_view::npos) {
      return refused(text, "expected [6], [n<=16] or two of these");
    }
    if (extents.size() == CHIMERA_MAX_EXTENTS) return refused(text, "more than 2 dimensions");
    auto extent = parse_extent(text, rest.substr(1, close - 1));
    if (!extent) return extent.error();
    extents.push_back(*std::move(extent));
    rest.remove_prefix(close + 1);
  }
  for (const Extent& extent : extents)
    if (extent.is_shape && extents.size() > 1) return refused(text, "a shape variable stands alone");
  std::uint64_t count = 1;
  for (const Extent& extent : extents) count *= extent.max;
  if (count > kMaxExtent) return refused(text, "more than 65536 elements");
  return extents;
}

std::uint32_t max_count(std::span<const Extent> extents) noexcept {
  std::uint32_t count = 1;
  for (const Extent& extent : extents) count *= extent.max;
  return count;
}

}  // namespace chimera
