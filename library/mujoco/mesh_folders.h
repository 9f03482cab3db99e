// SPDX-License-Identifier: Apache-2.0
// Finds the files that a URDF file names as in ROS: "package://ur_description/meshes/base.stl".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chimera::library {

/// The search folders for the meshes of one URDF file.
class MeshFolders {
 public:
  /// `urdf` is the path of the file, `mesh_folder` the value of its <compiler meshdir>. Reads the environment:
  /// CHIMERA_PACKAGE_PATH and ROS_PACKAGE_PATH list packages or folders of packages; AMENT_PREFIX_PATH lists folders
  /// with packages in `share`. Context: setup.
  explicit MeshFolders(const std::string& urdf, std::string_view mesh_folder = {});

  /// Returns the path of the file that the URDF file calls `name`; empty, with `why`, if there is none. The search for
  /// package:// visits the folders above the URDF file that are the package or contain it, then those of the
  /// environment. file:// and plain paths are used directly, relative ones from the folder of the URDF file. The last
  /// place is a file of that name beside the URDF file. Context: setup; may block.
  std::string find(std::string_view name, std::string& why) const;

 private:
  std::string in_package(std::string_view package, std::string_view rest) const;

  std::string here_;
  std::vector<std::string> meshes_here_;  // folders that may hold a file of the bare name
  std::vector<std::string> holders_;      // folders that may be a package or hold one
};

}  // namespace chimera::library
