// SPDX-License-Identifier: Apache-2.0
// The folder in which commands keep files between two calls: the history of the shell, the record of `save`.
#pragma once

#include <string>

namespace chimera::cli {

/// $XDG_STATE_HOME/chimera, else $HOME/.local/state/chimera, else "". Context of all: setup.
std::string state_folder();
/// Makes it, for the user alone; false when it cannot be had.
bool make_state_folder();

}  // namespace chimera::cli
