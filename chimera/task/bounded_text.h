// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string_view>

namespace chimera::component_api {

/// Writes the parts one after another into `size` bytes, cut so that the closing zero fits. Context: any; wait-free.
inline void put_text(char* to, std::size_t size, std::initializer_list<std::string_view> parts) noexcept {
  std::size_t n = 0;
  for (const std::string_view part : parts)
    for (const char c : part)
      if (n + 1 < size) to[n++] = c;
  to[n] = '\0';
}

}  // namespace chimera::component_api
