// SPDX-License-Identifier: Apache-2.0
// Which subsystems of this user run, by their sockets (platform/socket_folder.h): docs/formats/control.md, "The
// socket".
#pragma once

#include <string>
#include <vector>

namespace chimera::control {

/// FOLDER/SUBSYSTEM.sock.
std::string socket_path(const std::string& folder, const std::string& subsystem);
/// The names of the subsystems that listen in the folder, in alphabetical order. May block a moment.
std::vector<std::string> running_subsystems(const std::string& folder);

}  // namespace chimera::control
