// SPDX-License-Identifier: Apache-2.0
#include "library/mujoco/mesh_folders.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "library/mujoco/testing/package_of_meshes.h"

namespace chimera::library {
namespace {

struct MeshFoldersTest : ::testing::Test {
  PackageOfMeshes files;
  std::string why;

  ~MeshFoldersTest() override {
    for (const char* variable : {"CHIMERA_PACKAGE_PATH", "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"}) ::unsetenv(variable);
  }
  std::string find(const std::string& name, const char* mesh_folder = "") {
    why.clear();
    const std::string found = MeshFolders(files.urdf, mesh_folder).find(name, why);
    EXPECT_EQ(found.empty(), !why.empty()) << found << why;
    return found.empty() ? "" : std::filesystem::relative(found, files.root).string();
  }
};

TEST_F(MeshFoldersTest, APackageIsAFolderAboveTheFileOrBesideOne) {
  files.put(files.package / "meshes" / "base.stl", "x");
  files.put(files.root / "ws" / "gripper" / "meshes" / "finger.stl", "x");
  EXPECT_EQ(find("package://arm_description/meshes/base.stl"), "ws/arm_description/meshes/base.stl");
  EXPECT_EQ(find("package://gripper/meshes/finger.stl"), "ws/gripper/meshes/finger.stl");
  EXPECT_EQ(find("package://other/meshes/base.stl"), "");
  EXPECT_EQ(why, "not found; CHIMERA_PACKAGE_PATH lists folders of packages");
  files.put(files.package / "package.xml", "<package>\n  <name>other</name>\n</package>");
  EXPECT_EQ(find("package://other/meshes/base.stl"), "ws/arm_description/meshes/base.stl");
}

TEST_F(MeshFoldersTest, TheEnvironmentListsFoldersThatArePackagesOrHoldSome) {
  files.put(files.root / "a" / "share" / "far" / "meshes" / "m.stl", "x");
  EXPECT_EQ(find("package://far/meshes/m.stl"), "");
  const auto found_with = [&](const char* variable, const std::filesystem::path& folder) {
    ::setenv(variable, ("/no/such:" + (files.root / folder).string() + ":").c_str(), 1);
    const std::string found = find("package://far/meshes/m.stl");
    ::unsetenv(variable);
    return found;
  };
  EXPECT_EQ(found_with("CHIMERA_PACKAGE_PATH", "a/share"), "a/share/far/meshes/m.stl");
  EXPECT_EQ(found_with("CHIMERA_PACKAGE_PATH", "a/share/far"), "a/share/far/meshes/m.stl");
  EXPECT_EQ(found_with("ROS_PACKAGE_PATH", "a/share"), "a/share/far/meshes/m.stl");
  EXPECT_EQ(found_with("AMENT_PREFIX_PATH", "a"), "a/share/far/meshes/m.stl");
}

TEST_F(MeshFoldersTest, PathsAreTakenFromTheFolderOfTheFileAndABareNameLast) {
  files.put(files.package / "meshes" / "base.stl", "x");
  files.put(files.package / "urdf" / "here.stl", "x");
  EXPECT_EQ(find("../meshes/base.stl"), "ws/arm_description/meshes/base.stl");
  EXPECT_EQ(find("file://" + (files.package / "meshes/base.stl").string()), "ws/arm_description/meshes/base.stl");
  EXPECT_EQ(find((files.package / "meshes/base.stl").string()), "ws/arm_description/meshes/base.stl");
  EXPECT_EQ(find("package://nowhere/x/here.stl"), "ws/arm_description/urdf/here.stl");
  EXPECT_EQ(find("base.stl", "../meshes"), "ws/arm_description/meshes/base.stl");
}

TEST_F(MeshFoldersTest, RefusesAPathThatLeadsOutOrNamesNoFile) {
  files.put(files.root / "ws" / "secret.stl", "x");
  files.put(files.package / "meshes" / "folder.stl" / "x", "x");
  const auto refusal = [&](const std::string& name) {
    EXPECT_EQ(find(name), "") << name;
    return why;
  };
  EXPECT_EQ(refusal("package://arm_description/../secret.stl"), "leads out of its package");
  EXPECT_EQ(refusal("package://../secret.stl"), "leads out of its package");
  EXPECT_EQ(refusal("../meshes/folder.stl"), "is a folder");
  EXPECT_EQ(refusal(""), "is no path");
  EXPECT_EQ(refusal(std::string(100000, 'a')), "is no path");
  EXPECT_EQ(refusal("package://"), "not found; CHIMERA_PACKAGE_PATH lists folders of packages");
  EXPECT_EQ(refusal("https://x/y.stl"), "not found; CHIMERA_PACKAGE_PATH lists folders of packages");
}

}  // namespace
}  // namespace chimera::library
