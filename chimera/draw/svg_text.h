// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace chimera::draw {

/// `text` as the content or an attribute of an SVG element; control characters become blanks. Context: any.
std::string escaped(const std::string& text);

}  // namespace chimera::draw
