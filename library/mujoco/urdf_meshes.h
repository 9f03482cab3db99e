// SPDX-License-Identifier: Apache-2.0
// A URDF file as ROS packages have them, made ready for MuJoCo: meshes come out of the folders they lie in, and a mesh
// that cannot be used is left out. Pictures (<visual>) with a mesh always are: nothing here draws, they weigh nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "library/mujoco/xml_tags.h"

namespace chimera::library {

/// A collision mesh of the file.
struct UrdfMesh {
  std::string called;  ///< as the file has it, "package://arm/meshes/base.stl"
  std::string scale;   ///< "" when it is not said
  std::string as;      ///< what it is called for MuJoCo: "mesh_0.stl"
  std::string bytes;   ///< what stands in the file; empty when it is left out
  std::string why;     ///< it is left out; empty: it is used
};

/// The text of one file. A mesh never weighs anything: a link with a mesh and no <inertial> gets one of nothing, so
/// masses are the same with its meshes and without. Lines keep their numbers.
class UrdfMeshes {
 public:
  /// False for a text without a mesh, and for one that is no URDF: both go to MuJoCo as they are. Context: setup.
  static bool are_in(std::string_view text);

  /// Looks for each mesh and reads it; `path` is where `text` comes from. Context: setup; may block.
  UrdfMeshes(std::string text, const std::string& path);

  const std::vector<UrdfMesh>& meshes() const noexcept { return meshes_; }
  /// Mesh `i` is left out for this reason.
  void leave_out(std::size_t i, std::string why);
  /// The text for MuJoCo, with the meshes that are used by their names `as`.
  std::string text() const;
  /// One line on what is left out; empty when nothing is.
  std::string note() const;

 private:
  static constexpr std::size_t kPicture = SIZE_MAX;
  struct Range {
    std::size_t begin = 0, end = 0;
  };
  struct Part {  // a <collision> or <visual>, and the mesh in it
    Range whole;
    std::size_t mesh = kPicture;
    Range name;  // of the file
  };
  struct Link {
    std::size_t inside = 0;  // behind its start tag
    bool has_inertial = false, has_mesh = false;
  };

  void take(const XmlTag& tag);
  void take_mesh(const XmlTag& tag);
  void close(const XmlTag& tag);

  std::string source_;
  std::vector<UrdfMesh> meshes_;
  std::vector<Part> parts_;
  std::vector<std::size_t> weightless_;  // where an <inertial> is put
  std::string mesh_folder_;
  // While it reads.
  Link link_;
  Part part_;
  bool is_in_part_ = false, is_picture_ = false, has_name_ = false;
};

}  // namespace chimera::library
