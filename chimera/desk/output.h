// SPDX-License-Identifier: Apache-2.0
// What a command says and how it ends. Commands fill this in; the program prints it.
#pragma once

#include <string>

#include "chimera/base/result.h"
#include "chimera/text/json_text.h"

namespace chimera::desk {

inline constexpr int kOk = 0;       ///< done
inline constexpr int kRefused = 1;  ///< what was asked is not legal, or went wrong
inline constexpr int kUsage = 2;    ///< the call itself is wrong

struct Output {
  std::string out;  ///< for standard output
  std::string err;  ///< for standard error
  int code = kOk;
};

/// "arm.yaml:3:4: error: message", for standard error. Context: setup.
std::string error_line(const Error& error);
/// An Output that only says `error`, as text or as {"error": {...}}.
Output refused(const Error& error, bool json, int code = kRefused);

}  // namespace chimera::desk
