// SPDX-License-Identifier: Apache-2.0
// What this process holds of the system.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace chimera {

/// Open file descriptors, each as "7 -> /dev/null".
struct Descriptors {
  std::vector<std::string> names{};
};

/// Context: setup; may block.
Descriptors open_descriptors();
std::uint32_t threads();
/// Writes the first of `after` that is not in `before` to `text`, zero-terminated; nothing when there is none.
void name_first_new(const Descriptors& before, const Descriptors& after, std::span<char> text);

}  // namespace chimera
