// SPDX-License-Identifier: Apache-2.0
// Finds the installed components, units and templates from the place of the program and from the environment.
#include "chimera/catalogue/workplace.h"

#include <algorithm>
#include <filesystem>

#include "chimera/text/nearest.h"
#include "chimera/units/unit_system.h"

namespace chimera {

Workplace Workplace::around(const std::string& program) {
  const std::string folder = program.substr(0, program.rfind('/'));
  const std::string prefix = folder.substr(0, folder.rfind('/'));
  const std::vector<std::string> installed = {prefix + "/components", prefix + "/lib/chimera/components"};
  Workplace made;
  made.component_folders = chimera::component_folders(installed);
  made.unit_files = {prefix + "/share/chimera/units.xml", prefix + "/../../share/chimera/units.xml"};
  made.documents = prefix + "/share/chimera";
  const std::filesystem::path checkout = std::filesystem::path(prefix).parent_path().parent_path();
  std::error_code unknown;
  if (std::filesystem::is_directory(checkout / "docs/formats", unknown)) made.documents = checkout.string();
  return made;
}

Result<Library> Workplace::library(const std::string& description) const {
  auto units = UnitSystem::load(unit_files);
  if (!units) return units.error();
  std::vector<std::string> folders = component_folders;
  std::error_code unknown;
  const auto built = absolute(std::filesystem::path(description).parent_path() / "build/components", unknown);
  const auto behind_path = static_cast<std::ptrdiff_t>(std::min(chimera::component_folders({}).size(), folders.size()));
  if (std::filesystem::is_directory(built, unknown)) folders.insert(folders.begin() + behind_path, built.string());
  return Library::make(folders, *std::move(units));
}

Error no_component(const std::string& name, const Library& library) {
  for (const Error& fault : library.faults())
    if (fault.where.view().ends_with("/" + name + ".component.json"))
      return {fault.code, {std::string(fault.message.view()) + ". Rebuild the component."}, fault.where};
  const std::string nearest = library.nearest_name(name);
  std::string message = "no component '" + name + "' is installed";
  if (library.is_unbuilt(name))
    message = "the component '" + name + "' is not built: run './dev install' in the checkout";
  else if (!nearest.empty()) message += did_you_mean(nearest);
  else message += "; `chimera list` names those that are, CHIMERA_PATH says where to look";
  return {ErrorCode::kNotFound, {message}, {}};
}

std::string absolute_path(const std::string& path) {
  std::error_code unknown;
  const std::filesystem::path whole = std::filesystem::absolute(path, unknown);
  return unknown ? path : whole.string();
}

std::string program_path() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::string("chimera") : path.string();
}

}  // namespace chimera
