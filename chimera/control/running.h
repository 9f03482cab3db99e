// SPDX-License-Identifier: Apache-2.0
// Lists the running subsystems of this user by their sockets (platform/socket_place.h): docs/formats/control.md, "The
// socket".
#pragma once

#include <string>
#include <vector>

namespace chimera::control {

/// Folder of the subsystems that the machine runs as services (debian/chimera@.service): in /run, where only root makes
/// folders.
inline constexpr const char* kServiceFolder = "/run/chimera";

/// FOLDER/SUBSYSTEM.sock.
std::string socket_path(const std::string& folder, const std::string& subsystem);
/// The names of the subsystems that listen in the folder, in alphabetical order. May block a moment.
std::vector<std::string> running_subsystems(const std::string& folder);

/// `own`, where a subsystem of that name listens, or any when `name` is empty; else `services`, if one listens there;
/// else `own`. May block a moment.
std::string folder_with(const std::string& name, const std::string& own, const std::string& services);

}  // namespace chimera::control
