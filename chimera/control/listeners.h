// SPDX-License-Identifier: Apache-2.0
// The processes behind a control socket, told from /proc: for when none of them answers.
#pragma once

#include <string>

#include "chimera/base/time.h"

namespace chimera::control {

/// 0: not seen. Processes of other users are seen by root only.
struct Listeners {
  int keeper = 0, manager = 0;
  bool is_stopped = false;  ///< the manager, by a signal or a debugger
};

/// Those that hold the socket that listens at `path`. Context: setup; looks at every process of the machine.
Listeners listeners_at(const std::string& path);

/// That the manager behind `path` did not answer for so long, with its process and what to do about it.
std::string silence_text(const std::string& path, const Listeners& listeners, Nanoseconds limit);

}  // namespace chimera::control
