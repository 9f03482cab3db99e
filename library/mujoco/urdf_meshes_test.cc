// SPDX-License-Identifier: Apache-2.0
#include "library/mujoco/urdf_meshes.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "library/mujoco/testing/package_of_meshes.h"
#include "library/mujoco/simulated_arm.h"

namespace chimera::library {
namespace {

/// All numbers of the model, and of a fall under torques, that a mesh must not change by a bit.
std::vector<double> numbers_of(SimulatedArm& arm) {
  const mjModel* m = arm.model();
  std::vector<double> all;
  const auto add = [&](const double* from, int count) { all.insert(all.end(), from, from + count); };
  add(m->body_mass, m->nbody);
  add(m->body_inertia, 3 * m->nbody);
  add(m->body_ipos, 3 * m->nbody);
  add(m->body_iquat, 4 * m->nbody);
  add(m->jnt_pos, 3 * m->njnt);
  add(m->jnt_axis, 3 * m->njnt);
  add(m->jnt_range, 2 * m->njnt);
  add(m->dof_damping, m->nv);
  const std::vector<double> torque{1, -2, 0.5};
  for (int i = 0; i < 300; ++i) EXPECT_TRUE(arm.step(ArmInterface::kTorque, torque, 1e-3)) << arm.fault();
  add(arm.position().data(), 3);
  add(arm.velocity().data(), 3);
  return all;
}

struct UrdfMeshesTest : ::testing::Test {
  PackageOfMeshes files;
  const std::string kBase = "package://arm_description/meshes/upper.stl";
  const std::string kTool = "package://arm_description/meshes/tool.obj";

  void put_meshes(const std::string& upper, const std::string& tool) const {
    files.put(files.package / "meshes" / "upper.stl", upper);
    files.put(files.package / "meshes" / "tool.obj", tool);
  }
  void load(SimulatedArm& arm, const std::string& text) const {
    files.put(files.urdf, text);
    const Result<void> loaded = arm.load(files.urdf.c_str());
    ASSERT_TRUE(loaded) << loaded.error().message.c_str();
  }
  std::vector<double> numbers(const std::string& text) const {
    SimulatedArm arm;
    load(arm, text);
    return arm.model() == nullptr ? std::vector<double>{} : numbers_of(arm);
  }
  std::string note(const std::string& text) const {
    SimulatedArm arm;
    load(arm, text);
    EXPECT_LT(arm.note().size(), 160u) << arm.note();
    return arm.note();
  }
  /// Reason for leaving out the mesh of the upper arm with this name or these bytes.
  std::string reason(const std::string& called, const std::string& bytes = "") const {
    if (!bytes.empty()) files.put(files.package / "meshes" / "upper.stl", bytes);
    const std::string said = note(files.robot(files.mesh(called), ""));
    const std::size_t at = said.find("as stated: ");
    return at == std::string::npos ? said : said.substr(at + 11);
  }
};

TEST_F(UrdfMeshesTest, MeshesAreFoundReadAndChangeNoMassInertiaOrJoint) {
  put_meshes(stl_box(0.05F), kTetrahedron);
  const std::string with = files.robot(files.mesh(kBase), files.mesh(kTool));
  SimulatedArm arm;
  load(arm, with);
  EXPECT_EQ(arm.model()->nmesh, 2);
  EXPECT_EQ(arm.note(), "");
  EXPECT_EQ(numbers(with), numbers(files.robot("", "")));
}

TEST_F(UrdfMeshesTest, AMeshThatIsNotThereIsLeftOutWithALineAndChangesNoNumber) {
  const std::string with = files.robot(files.mesh(kBase), files.mesh(kTool));
  EXPECT_EQ(numbers(with), numbers(files.robot("", "")));
  EXPECT_EQ(note(with), "2 of 2 collision meshes left out, masses and joints as stated: upper.stl: not found; "
                        "CHIMERA_PACKAGE_PATH lists folders of packages; and 1 more");
  files.put(files.package / "meshes" / "tool.obj", kTetrahedron);
  SimulatedArm arm;
  load(arm, with);
  EXPECT_EQ(arm.model()->nmesh, 1);
  EXPECT_TRUE(arm.note().starts_with("1 of 2 ")) << arm.note();
}

TEST_F(UrdfMeshesTest, PicturesAreNotLookedFor) {
  EXPECT_EQ(note(files.robot(files.mesh("package://arm_description/meshes/upper.dae", "visual"), "")), "");
}

TEST_F(UrdfMeshesTest, SaysWhyAMeshIsLeftOut) {
  EXPECT_EQ(reason("package://arm_description/meshes/upper.dae"), "upper.dae: MuJoCo reads STL and OBJ");
  EXPECT_EQ(reason("package://arm_description/../../upper.stl"), "upper.stl: leads out of its package");
  EXPECT_EQ(reason(std::string(5000, 'a') + ".stl"), std::string(32, 'a') + "...: is no path");
  EXPECT_EQ(reason(kBase, "solid a\nfacet normal 0 0 1\n"), "upper.stl: is an STL of text; MuJoCo reads binary ones");
  EXPECT_EQ(reason(kBase, stl_box(1).substr(0, 300)), "upper.stl: is a damaged STL");
  EXPECT_EQ(reason(kBase, stl_box(1) + "x"), "upper.stl: is a damaged STL");
  std::string many = stl_box(1);
  std::fill_n(many.begin() + 80, 4, '\xff');
  EXPECT_EQ(reason(kBase, many), "upper.stl: is a damaged STL");
}

// MuJoCo alone decides whether a well-formed mesh is a body, so each mesh is tried by itself.
TEST_F(UrdfMeshesTest, AMeshThatMujocoRefusesIsLeftOutAndTheOthersStay) {
  std::string bad = stl_box(0.05F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bad.data() + 84 + 12, &nan, sizeof nan);
  put_meshes(bad, kTetrahedron);
  SimulatedArm arm;
  load(arm, files.robot(files.mesh(kBase), files.mesh(kTool)));
  EXPECT_EQ(arm.model()->nmesh, 1);
  EXPECT_NE(arm.note().find("1 of 2 collision meshes left out"), std::string::npos) << arm.note();
  EXPECT_NE(arm.note().find("contains invalid vertices"), std::string::npos) << arm.note();
}

TEST_F(UrdfMeshesTest, AnObjFileOfFacesWithoutVerticesIsNoMesh) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  for (const std::string& text : {points + "f 1 2 9\n", points + "f 1 2 -9\n", points + "v 1 0 nan\nf 1 2 3\n",
                                  std::string("v 0 0\n"), std::string("v 0 0 0\nf 1 1 1\n"), std::string("garbage")}) {
    put_meshes(stl_box(1), text);
    EXPECT_NE(note(files.robot("", files.mesh(kTool))).find("OBJ"), std::string::npos) << text;
  }
}

TEST_F(UrdfMeshesTest, LinesKeepTheirNumbersAndOtherElementsStay) {
  const std::string text = "<robot name='r'>\n<link name='a'>\n" + files.mesh("x.dae") + "<!-- <mesh/> -->\n</link>" +
                           files.mesh("y.dae", "visual") + "<link name='b'><inertial/></link>\n</robot>";
  ASSERT_TRUE(UrdfMeshes::are_in(text));
  const std::string made = UrdfMeshes(text, files.urdf).text();
  EXPECT_EQ(std::ranges::count(made, '\n'), std::ranges::count(text, '\n'));
  EXPECT_EQ(made.find("mesh filename"), std::string::npos);
  EXPECT_NE(made.find("<link name='a'><inertial><mass value=\"0\"/>"), std::string::npos) << made;
  EXPECT_NE(made.find("<link name='b'><inertial/></link>"), std::string::npos);
  EXPECT_FALSE(UrdfMeshes::are_in("<robot><link name='a'/></robot>"));
  EXPECT_FALSE(UrdfMeshes::are_in("<mujoco><asset><mesh file='x.stl'/></asset></mujoco>"));
}

TEST_F(UrdfMeshesTest, ATextThatIsCutAnywhereKeepsItsLines) {
  const std::string text = files.robot(files.mesh(kBase), files.mesh("x.dae") + files.mesh(kTool, "visual"));
  for (std::size_t n = 0; n <= text.size(); ++n) {
    const std::string cut = text.substr(0, n);
    const std::string made = UrdfMeshes(cut, files.urdf).text();
    ASSERT_EQ(std::ranges::count(made, '\n'), std::ranges::count(cut, '\n')) << cut;
  }
}

TEST_F(UrdfMeshesTest, AMovingLinkThatOnlyAMeshWouldWeighIsRefusedWithTheRemedy) {
  put_meshes(stl_box(0.05F), kTetrahedron);
  std::string text = files.robot(files.mesh(kBase), "");
  const std::size_t begin = text.find("<inertial>", text.find("name='upper'"));
  text.erase(begin, text.find("</inertial>", begin) + 11 - begin);
  files.put(files.urdf, text);
  SimulatedArm arm;
  const Result<void> loaded = arm.load(files.urdf.c_str());
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().message.view(),
            files.urdf + ": Error: mass and inertia of moving bodies must be larger than mjMINVAL Object name = upper, "
                         "id = 2; a mesh weighs nothing, say it in <inertial>");
}

}  // namespace
}  // namespace chimera::library
