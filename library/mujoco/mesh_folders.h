// SPDX-License-Identifier: Apache-2.0
// Where the files lie that a URDF file names as ROS does: "package://ur_description/meshes/base.stl".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chimera::library {

/// The folders in which the meshes of one URDF file are looked for.
class MeshFolders {
 public:
  /// `urdf` is the path of the file; `mesh_folder` what its <compiler meshdir> says. Reads the environment:
  /// CHIMERA_PACKAGE_PATH and ROS_PACKAGE_PATH, lists of folders that are packages or hold some, and AMENT_PREFIX_PATH,
  /// whose folders hold them in `share`. Context: setup.
  explicit MeshFolders(const std::string& urdf, std::string_view mesh_folder = {});

  /// The path of the file that the URDF calls `name`; empty, with `why`, when there is none. What begins with
  /// package:// is looked for in the folders above the URDF file that are the package, or hold it, then in those of the
  /// environment; file:// and plain paths are taken as they are, relative ones from the folder of the URDF. Last comes
  /// a file of that name beside the URDF. Context: setup; may block.
  std::string find(std::string_view name, std::string& why) const;

 private:
  std::string in_package(std::string_view package, std::string_view rest) const;

  std::string here_;
  std::vector<std::string> meshes_here_;  // folders for the bare name
  std::vector<std::string> holders_;      // folders that may be a package or hold one
};

}  // namespace chimera::library
