// SPDX-License-Identifier: Apache-2.0
// What a command of this folder says and how it ends.
#pragma once

#include <cstdio>
#include <string>

namespace chimera::shell {

inline constexpr int kOk = 0;       ///< done
inline constexpr int kRefused = 1;  ///< the subsystem said no, or is not there
inline constexpr int kUsage = 2;    ///< the call itself is wrong

struct Said {
  std::string out;  ///< for standard output
  std::string err;  ///< for standard error
  int code = kOk;
};

/// Writes both texts and returns the code. Context: edge; may block.
int print(const Said& said, std::FILE* out, std::FILE* err);

}  // namespace chimera::shell
