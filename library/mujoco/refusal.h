// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>

#include "chimera/base/result.h"

namespace chimera::library {

/// Makes an Error with a text in printf form. Context: setup.
template <class... Values>
Error refusal(const char* format, Values... values) {
  Error error;
  char text[1024];  // the message cuts a longer text
  std::snprintf(text, sizeof text, format, values...);
  error.message = FixedString<400>(text);
  return error;
}

}  // namespace chimera::library
