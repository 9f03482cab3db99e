// SPDX-License-Identifier: Apache-2.0
// The folder in which files are kept between two calls and two runs: the history of the shell, the record of `save`,
// receipts and events of each subsystem.
#pragma once

#include <string>

namespace chimera::control {

/// $XDG_STATE_HOME/chimera, else $HOME/.local/state/chimera, else "". Context of all: setup.
std::string state_folder();
/// Makes it, for the user alone; false when it cannot be had.
bool make_state_folder();

/// The folder in it of that subsystem; "" without one. It need not be there.
std::string state_folder_of(const std::string& subsystem);

}  // namespace chimera::control
