// SPDX-License-Identifier: Apache-2.0
// The result of every command of `chimera`: its output and its exit code.
#pragma once

#include <cstdio>
#include <string>

namespace chimera::cli {

inline constexpr int kOk = 0;       ///< done
inline constexpr int kRefused = 1;  ///< what was asked is not legal, went wrong, or the subsystem is not there
inline constexpr int kUsage = 2;    ///< the call itself is wrong

/// Plain value.
struct CommandResult {
  std::string out;  ///< for standard output
  std::string err;  ///< for standard error
  int code = kOk;
};

/// Writes both texts, fit for a terminal, and returns the code. Context: setup; may block.
int print(const CommandResult& result, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
