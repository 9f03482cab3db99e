// SPDX-License-Identifier: Apache-2.0
// Finds the processes behind a control socket in /proc, for the case that none of them answers.
#pragma once

#include <string>

#include "chimera/base/time.h"

namespace chimera::control {

/// 0: not seen. Processes of other users are seen by root only.
struct Listeners {
  int keeper = 0, manager = 0;
  bool is_stopped = false;  ///< the manager, by a signal or a debugger
};

/// The processes that hold the socket that listens at `path`. Context: setup; reads /proc of every process.
Listeners listeners_at(const std::string& path);

/// The sentence that the manager behind `path` did not answer for `limit`, with its process and what to do.
std::string silence_text(const std::string& path, const Listeners& listeners, Nanoseconds limit);

}  // namespace chimera::control
