// SPDX-License-Identifier: Apache-2.0
// The path of each key of a text, such as tasks/pid/alias/q_ref. Faults carry it, so that a program finds the key.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/description/node.h"

namespace chimera {

/// Place::key is a number here; 0 stands for no key. A key and its value have one number, and so has an item of a list.
class KeyPaths {
 public:
  /// Numbers the places of `root` and of all below it. Context: setup.
  explicit KeyPaths(Node& root);

  /// The names from the root to `key`; an item of a list counts from 0. Empty for a key that the tree does not have.
  /// Context: setup.
  std::vector<std::string> names(std::uint32_t key) const;
  /// The innermost key with a value at the place; 0: none. Context: setup.
  std::uint32_t key_at(Place at) const noexcept;

 private:
  void number(Node& node);

  struct Entry {
    std::uint32_t above = 0;
    std::string name;
    Place value;
  };
  std::vector<Entry> entries_;  // entry 0 is the root
};

}  // namespace chimera
