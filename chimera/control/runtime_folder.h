// SPDX-License-Identifier: Apache-2.0
// Where the sockets of a user's subsystems are: docs/formats/control.md, "The socket".
#pragma once

#include <string>
#include <vector>

namespace chimera::control {

/// $XDG_RUNTIME_DIR/chimera, else /run/user/UID/chimera where that user has one, else /tmp/chimera-UID. Context: setup.
std::string socket_folder();
/// FOLDER/SUBSYSTEM.sock.
std::string socket_path(const std::string& folder, const std::string& subsystem);
/// The names of the subsystems that listen in the folder, in alphabetical order. May block a moment.
std::vector<std::string> running_subsystems(const std::string& folder);

}  // namespace chimera::control
