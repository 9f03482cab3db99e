// SPDX-License-Identifier: Apache-2.0
// Looks for a ROS package in the folders around a URDF file and in the package paths of the environment.
#include "library/mujoco/mesh_folders.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace chimera::library {
namespace {

namespace fs = std::filesystem;

constexpr int kMostAbove = 8;  // folders above the URDF file
constexpr std::size_t kLongestName = 1024;
constexpr std::size_t kLongestManifest = 65536;

void add_list(std::vector<std::string>& folders, const char* variable, const char* behind) {
  const char* value = std::getenv(variable);
  for (std::string_view rest = value == nullptr ? "" : value; !rest.empty();) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    if (!folder.empty()) folders.push_back(std::string(folder) + behind);
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
  }
}

bool is_file(const fs::path& path) {
  std::error_code fault;
  return fs::is_regular_file(path, fault);
}

/// The folder of a checkout may have another name than its package; package.xml states the name.
bool is_package(const fs::path& folder, std::string_view package) {
  if (folder.filename() == package) return true;
  std::ifstream manifest(folder / "package.xml");
  std::string text(kLongestManifest, '\0');
  manifest.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(manifest.gcount()));
  return text.find("<name>" + std::string(package) + "</name>") != std::string::npos;
}

bool leads_out(std::string_view rest) {
  for (const fs::path& part : fs::path(rest))
    if (part == "..") return true;
  return false;
}

}  // namespace

MeshFolders::MeshFolders(const std::string& urdf, std::string_view mesh_folder) {
  std::error_code fault;
  const fs::path file = fs::weakly_canonical(urdf, fault);
  const fs::path folder = fault ? fs::path(urdf).parent_path() : file.parent_path();
  here_ = folder.string();
  if (!mesh_folder.empty()) meshes_here_.push_back((folder / mesh_folder).string());
  meshes_here_.push_back(here_);
  fs::path above = folder;
  for (int i = 0; i < kMostAbove && above.has_relative_path(); ++i, above = above.parent_path())
    holders_.push_back(above.string());
  add_list(holders_, "CHIMERA_PACKAGE_PATH", "");
  add_list(holders_, "ROS_PACKAGE_PATH", "");
  add_list(holders_, "AMENT_PREFIX_PATH", "/share");
}

std::string MeshFolders::in_package(std::string_view package, std::string_view rest) const {
  for (const fs::path holder : holders_) {
    if (is_file(holder / package / rest)) return (holder / package / rest).string();
    if (is_file(holder / rest) && is_package(holder, package)) return (holder / rest).string();
  }
  return {};
}

std::string MeshFolders::find(std::string_view name, std::string& why) const {
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  if (name.empty() || name.size() > kLongestName || name.find('\0') != std::string_view::npos)
    return why = "is no path", "";
  std::string found;
  if (name.starts_with(kPackage)) {
    const std::string_view inside = name.substr(kPackage.size());
    const std::string_view package = inside.substr(0, inside.find('/'));
    const std::string_view rest = inside.substr(std::min(inside.size(), package.size() + 1));
    if (leads_out(inside)) return why = "leads out of its package", "";
    found = in_package(package, rest);
  } else {
    if (name.starts_with(kFile)) name.remove_prefix(kFile.size());
    const fs::path path = fs::path(here_) / name;
    std::error_code fault;
    if (fs::is_directory(path, fault)) return why = "is a folder", "";
    if (is_file(path)) found = path.string();
  }
  const std::string bare = fs::path(name).filename().string();
  for (const std::string& folder : meshes_here_)
    if (found.empty() && is_file(fs::path(folder) / bare)) found = (fs::path(folder) / bare).string();
  if (found.empty()) why = "not found; CHIMERA_PACKAGE_PATH lists folders of packages";
  return found;
}

}  // namespace chimera::library
