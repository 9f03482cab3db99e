// SPDX-License-Identifier: Apache-2.0
// Runs `init` of the tasks of an image on this machine, so that what a component refuses is known before the board has
// it.
#pragma once

#include <string>
#include <vector>

#include "chimera/bake/application.h"
#include "chimera/catalogue/library.h"

namespace chimera::cli {

/// Results in the order of initialisation.
struct DeskInit {
  std::vector<std::string> refusals;  ///< "task 'pid': 'init' refuses: kp must be above 0"
  /// Tasks whose `init` needs a pin, an interrupt or the serial line, or a constant of such a task.
  std::vector<std::string> untried;
};

/// Calls `init` of each task once in virtual time, in a process of its own, then `kill`. Tasks that need a constant of
/// a task that refuses are left out. Context: setup; may block.
DeskInit init_at_desk(const bake::BakedApplication& application, const Library& library);

}  // namespace chimera::cli
