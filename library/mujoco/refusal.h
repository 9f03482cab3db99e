// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>

#include "chimera/base/result.h"

namespace chimera::library {

/// An error with such a text, as printf makes it. Context: setup.
template <class... Values>
Error refusal(const char* format, Values... values) {
  Error error;
  char text[1024];  // the message keeps what it has room for
  std::snprintf(text, sizeof text, format, values...);
  error.message = FixedString<400>(text);
  return error;
}

}  // namespace chimera::library
