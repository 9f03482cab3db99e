// SPDX-License-Identifier: Apache-2.0
// Finds and makes the folder of what outlives a call.
#include "chimera/control/state_folder.h"

#include <cstdlib>
#include <filesystem>

#include "chimera/platform/file.h"

namespace chimera::control {

std::string state_folder() {
  const char* given = std::getenv("XDG_STATE_HOME");
  if (given != nullptr && *given == '/') return std::string(given) + "/chimera";
  const char* home = std::getenv("HOME");
  return home != nullptr && *home == '/' ? std::string(home) + "/.local/state/chimera" : "";
}

bool make_state_folder() {
  const std::filesystem::path folder = state_folder();
  if (folder.empty()) return false;
  std::error_code error;
  std::filesystem::create_directories(folder.parent_path(), error);
  return make_private_folder(folder.string());
}

std::string state_folder_of(const std::string& subsystem) {
  const std::string folder = state_folder();
  return folder.empty() ? "" : folder + "/" + subsystem;
}

}  // namespace chimera::control
