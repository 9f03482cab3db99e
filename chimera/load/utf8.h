// SPDX-License-Identifier: Apache-2.0
// Checks that bytes are UTF-8 text, because descriptors and messages go into JSON.
#pragma once

#include <string_view>

namespace chimera {

/// Well-formed UTF-8 without surrogates, overlong forms and zero bytes. Context: any; wait-free; O(bytes).
bool is_utf8(std::string_view bytes) noexcept;

}  // namespace chimera
