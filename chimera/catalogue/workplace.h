// SPDX-License-Identifier: Apache-2.0
// Places where the commands find the installed components, units and templates.
#pragma once

#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/catalogue/library.h"

namespace chimera {

/// Folders and files, in the order in which they are searched. Context: setup.
struct Workplace {
  std::vector<std::string> component_folders;
  std::vector<std::string> unit_files;
  std::string documents{};  ///< where docs/ and examples/ are, which messages name

  /// The places of the program at `program` (its own path): CHIMERA_PATH first, then the tree that it was built
  /// or installed in (../components, ../lib/chimera/components; ../share/chimera/units.xml, or the source's).
  static Workplace around(const std::string& program);
  /// All installed components, and those in `build/components` beside `description` (left out: in the present folder),
  /// searched behind CHIMERA_PATH. Refuses when there is no unit file. May block.
  Result<Library> library(const std::string& description = {}) const;
};

/// The error "no component NAME is installed", with the nearest installed name. Context: setup.
Error no_component(const std::string& name, const Library& library);

/// The path from the root; `path` itself if the present folder is gone. Context: setup.
std::string absolute_path(const std::string& path);

/// The path of the running program. Context: setup.
std::string program_path();

}  // namespace chimera
