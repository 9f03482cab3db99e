// SPDX-License-Identifier: Apache-2.0
// Lists the sockets of a folder at which a process listens.
#include "chimera/control/running.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "chimera/platform/local_socket.h"

namespace chimera::control {
std::string socket_path(const std::string& folder, const std::string& subsystem) {
  return folder + "/" + subsystem + ".sock";
}

std::vector<std::string> running_subsystems(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  std::filesystem::directory_iterator entries(folder, error);
  for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
    const std::filesystem::path path = entries->path();
    if (path.extension() == ".sock" && is_listened_at(path.string())) names.push_back(path.stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string folder_with(const std::string& name, const std::string& own, const std::string& services) {
  const auto has = [&name](const std::vector<std::string>& running) {
    return name.empty() ? !running.empty() : std::find(running.begin(), running.end(), name) != running.end();
  };
  return !has(running_subsystems(own)) && has(running_subsystems(services)) ? services : own;
}

}  // namespace chimera::control
