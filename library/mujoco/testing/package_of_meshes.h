// SPDX-License-Identifier: Apache-2.0
// For tests: a folder in the form of a ROS package, with a robot of three joints and meshes of its links.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

namespace chimera::library {

/// A box of half size `half` as a binary STL file.
inline std::string stl_box(float half) {
  constexpr int kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::string bytes(80, ' ');
  const std::uint32_t count = 12;
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (const auto& face : kFaces) {
    float numbers[12] = {};
    for (int corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis)
        numbers[3 + 3 * corner + axis] = (face[corner] >> axis & 1) != 0 ? half : -half;
    bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
    bytes.append(2, '\0');
  }
  return bytes;
}

inline constexpr char kTetrahedron[] =
    "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// DIR/ws/arm_description/{urdf,meshes}, removed by the destructor.
struct PackageOfMeshes {
  std::filesystem::path root =
      std::filesystem::temp_directory_path() / ("package_of_meshes_" + std::to_string(::getpid()));
  std::filesystem::path package = root / "ws" / "arm_description";
  std::string urdf = (package / "urdf" / "arm.urdf").string();

  PackageOfMeshes() { std::filesystem::create_directories(package / "urdf"); }
  ~PackageOfMeshes() { std::filesystem::remove_all(root); }
  PackageOfMeshes(const PackageOfMeshes&) = delete;
  PackageOfMeshes& operator=(const PackageOfMeshes&) = delete;

  /// `path` is relative to `root`.
  static void put(const std::filesystem::path& path, const std::string& bytes) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
  }
  static std::string mesh(const std::string& name, const std::string& kind = "collision") {
    const std::string geometry = "<geometry><mesh filename=\"" + name + "\"/></geometry>";
    return "<" + kind + ">\n<origin xyz='0 0 0.1'/>" + geometry + "\n</" + kind + ">";
  }
  /// Four links with mass. The second contains `upper`, the tool on the fourth contains `tool`. The tool has no
  /// <inertial>, as flanges in such packages.
  static std::string robot(const std::string& upper, const std::string& tool) {
    const auto link = [](const std::string& name, const std::string& inside) {
      return "<link name='" + name + "'>" + inside +
             "<inertial><origin xyz='.1 .02 0' rpy='0 .1 0'/><mass value='1.7'/>\n"
             "<inertia ixx='.02' ixy='.001' ixz='0' iyy='.03' iyz='0' izz='.025'/></inertial></link>\n";
    };
    const auto joint = [](const std::string& name, const std::string& parent, const std::string& child) {
      return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child +
             "'/><origin xyz='.4 0 .3' rpy='.2 0 0'/><axis xyz='0 1 0'/>"
             "<limit lower='-2' upper='2' effort='50' velocity='3'/><dynamics damping='.2'/></joint>\n";
    };
    return "<?xml version=\"1.0\"?>\n<robot name='arm'>\n<link name='base'/>\n" + link("shoulder", "") +
           link("upper", upper) + link("wrist", "") + "<link name='tool'>" + tool + "</link>\n" +
           joint("j1", "base", "shoulder") + joint("j2", "shoulder", "upper") + joint("j3", "upper", "wrist") +
           "<joint name='flange' type='fixed'><parent link='wrist'/><child link='tool'/>"
           "<origin xyz='.2 0 0'/></joint>\n</robot>\n";
  }
};

}  // namespace chimera::library
