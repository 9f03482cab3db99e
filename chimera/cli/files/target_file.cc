// SPDX-License-Identifier: Apache-2.0
// The target's text is read before it is judged; a missing file is a refusal of its own.
#include "chimera/cli/files/target_file.h"

#include <optional>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/description/yaml_reader.h"

namespace chimera::cli {
namespace {

std::string path_of(const std::string& name, const Workplace& workplace) {
  return workplace.documents + "/firmware/targets/" + name + ".yaml";
}

}  // namespace

Result<bake::ReadTarget> read_target_named(const std::string& name, const Workplace& workplace, std::string& file) {
  file = name.ends_with(".yaml") ? name : path_of(name, workplace);
  const auto text = read_ordinary(file, kMaxTextBytes + 1);
  if (!text) {
    const std::string of = "the target '" + name + "' cannot be read: ";
    return Error{text.error().code, {of + text.error().message.c_str()}, {file}};
  }
  const auto find = [&workplace](const std::string& like, std::string& at) -> std::optional<std::string> {
    at = path_of(like, workplace);
    auto found = read_ordinary(at, kMaxTextBytes + 1);
    return found ? std::optional(*std::move(found)) : std::nullopt;
  };
  return bake::read_target(*text, file, find);
}

}  // namespace chimera::cli
