// SPDX-License-Identifier: Apache-2.0
// Prepares the URDF file of a ROS package for MuJoCo: finds its meshes and leaves out those that cannot be used.
// <visual> elements with a mesh are always left out, because they are not drawn and have no mass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "library/model_text/xml_tags.h"

namespace chimera::library {

/// A collision mesh of the file.
struct UrdfMesh {
  std::string called;  ///< name in the file, "package://arm/meshes/base.stl"
  std::string scale;   ///< "" without a scale
  std::string as;      ///< name for MuJoCo: "mesh_0.stl"
  std::string bytes;   ///< contents of the file; empty if the mesh is left out
  std::string why;     ///< reason for leaving it out; empty if it is used
};

/// The text of one file. A mesh has no mass: a link with a mesh and without <inertial> gets a massless one, so masses
/// are the same with and without meshes. Line numbers do not change.
class UrdfMeshes {
 public:
  /// Returns false for a text without a mesh, or which is no URDF. MuJoCo reads both unchanged. Context: setup.
  static bool are_in(std::string_view text);

  /// Finds and reads each mesh. `path` is the file of `text`. Context: setup; may block.
  UrdfMeshes(std::string text, const std::string& path);

  const std::vector<UrdfMesh>& meshes() const noexcept { return meshes_; }
  /// Leaves out mesh `i` for the reason `why`.
  void leave_out(std::size_t i, std::string why);
  /// The text for MuJoCo, with used meshes under their names `as`.
  std::string text() const;
  /// One line about meshes that are left out; empty without any.
  std::string note() const;

 private:
  static constexpr std::size_t kPicture = SIZE_MAX;
  struct Range {
    std::size_t begin = 0, end = 0;
  };
  struct Part {  // a <collision> or <visual> element, and its mesh
    Range whole;
    std::size_t mesh = kPicture;
    Range name;  // position of the file name
  };
  struct Link {
    std::size_t inside = 0;  // after its start tag
    bool has_inertial = false, has_mesh = false;
  };

  void take(const XmlTag& tag);
  void take_mesh(const XmlTag& tag);
  void close(const XmlTag& tag);

  std::string source_;
  std::vector<UrdfMesh> meshes_;
  std::vector<Part> parts_;
  std::vector<std::size_t> weightless_;  // places that need an <inertial>
  std::string mesh_folder_;
  // Used while reading.
  Link link_;
  Part part_;
  bool is_in_part_ = false, is_picture_ = false, has_name_ = false;
};

}  // namespace chimera::library
