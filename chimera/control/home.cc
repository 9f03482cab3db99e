// SPDX-License-Identifier: Apache-2.0
// Commands of one terminal have one session, whose number nobody else gets while a process of it lives.
#include "chimera/control/home.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "chimera/platform/process_state.h"

namespace chimera::control {
namespace {

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::int64_t whole_of(const Json& object, const char* key, std::int64_t otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_integer() ? found->get<std::int64_t>() : otherwise;
}

bool is_working_folder(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::equivalent(folder, ".", error) && !error;
}

}  // namespace

Home home_of(const Json& hello) {
  if (!hello.is_object()) return {};
  return {text_of(hello, "subsystem"), whole_of(hello, "keeper_pid", 0), whole_of(hello, "session", -1),
          text_of(hello, "folder"), text_of(hello, "file")};
}

bool is_here(const Home& home) {
  if (home.session == own_session()) return true;
  if (home.folder.empty()) return false;
  const std::filesystem::path folder = home.folder;
  return is_working_folder(folder) || (!home.file.empty() && is_working_folder((folder / home.file).parent_path()));
}

}  // namespace chimera::control
