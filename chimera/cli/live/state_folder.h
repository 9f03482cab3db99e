// SPDX-License-Identifier: Apache-2.0
// Where the faces remember things between two calls: the history of the shell, what `save` wrote.
#pragma once

#include <string>

namespace chimera::cli {

/// $XDG_STATE_HOME/chimera, else $HOME/.local/state/chimera, else "". Context of all: setup.
std::string state_folder();
/// Makes it, for the user alone; false when it cannot be had.
bool make_state_folder();

}  // namespace chimera::cli
