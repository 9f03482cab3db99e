// SPDX-License-Identifier: Apache-2.0
// A value of a description as written, with the place of every part.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/description/report.h"

namespace chimera {

/// A word of the text and its place.
struct Word {
  std::string text;
  Place at;

  bool empty() const noexcept { return text.empty(); }
};

/// A scalar, a list or a map, as written and not interpreted: `1 kHz` is a scalar with this text.
struct Node {
  enum class Kind : std::uint8_t { kNone, kScalar, kList, kMap };

  Kind kind = Kind::kNone;
  bool quoted = false;  ///< scalar: written in quotes, so a text and never a number
  Place at;
  std::string text;         ///< scalar
  std::vector<Word> keys;   ///< map: one per item
  std::vector<Node> items;  ///< list, map

  bool is_scalar() const noexcept { return kind == Kind::kScalar; }
  bool is_list() const noexcept { return kind == Kind::kList; }
  bool is_map() const noexcept { return kind == Kind::kMap; }
  /// True for an empty value (`key:` alone).
  bool is_none() const noexcept { return kind == Kind::kNone; }
  /// The item under `key`, or nullptr.
  const Node* find(std::string_view key) const noexcept {
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i].text == key) return &items[i];
    return nullptr;
  }
};

}  // namespace chimera
