// SPDX-License-Identifier: Apache-2.0
// Numbers the keys of a tree, and walks back from a number to the root.
#include "chimera/description/key_paths.h"

#include <algorithm>
#include <cstddef>

namespace chimera {

KeyPaths::KeyPaths(Node& root) : entries_(1) { number(root); }

void KeyPaths::number(Node& node) {
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const auto key = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({node.at.key, node.is_map() ? node.keys[i].text : std::to_string(i), node.items[i].at});
    if (node.is_map()) node.keys[i].at.key = key;
    node.items[i].at.key = key;
    number(node.items[i]);
  }
}

std::uint32_t KeyPaths::key_at(Place at) const noexcept {
  std::uint32_t found = 0;
  for (std::uint32_t key = 1; key < entries_.size(); ++key)
    if (entries_[key].value == at) found = key;
  return found;
}

std::vector<std::string> KeyPaths::names(std::uint32_t key) const {
  std::vector<std::string> names;
  if (key >= entries_.size()) return names;
  for (; key != 0; key = entries_[key].above) names.push_back(entries_[key].name);
  std::ranges::reverse(names);
  return names;
}

}  // namespace chimera
