// SPDX-License-Identifier: Apache-2.0
// Commands of one terminal have one session. No other session gets its number while a process of it lives.
#include "chimera/control/home.h"

#include <filesystem>

#include "chimera/platform/process_state.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

bool is_working_folder(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::equivalent(folder, ".", error) && !error;
}

}  // namespace

Home home_of(const Json& hello) {
  if (!hello.is_object()) return {};
  return {text_at(hello, "subsystem"), whole_at(hello, "keeper_pid"), whole_at(hello, "session", -1),
          text_at(hello, "folder"), text_at(hello, "file")};
}

bool is_here(const Home& home) {
  if (home.session == own_session()) return true;
  if (home.folder.empty()) return false;
  const std::filesystem::path folder = home.folder;
  return is_working_folder(folder) || (!home.file.empty() && is_working_folder((folder / home.file).parent_path()));
}

}  // namespace chimera::control
