// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/task/rig.h"
#include "library/kinematics/dh_of_axes.h"
#include "library/rmms/module_store.h"

namespace chimera::library {
namespace {

std::string shipped(const std::string& file) { return source_path("library/rmms/" + file); }

struct StoreTest : ::testing::Test {
  std::string path = testing::TempDir() + "modules_" + std::to_string(::getpid()) + ".store";
  ~StoreTest() override { ::unlink(path.c_str()); }
  std::string refusal(const std::string& text) {
    std::ofstream(path) << text;
    const Result<ModuleStore> store = ModuleStore::read(path);
    return store ? "read" : std::string(store.error().message.view()).substr(path.size());
  }
};

TEST_F(StoreTest, ReadsItsModulesBaseToTip) {
  const Result<ModuleStore> store = ModuleStore::read(shipped("rmms_a.store"));
  ASSERT_TRUE(store) << store.error().message.view();
  ASSERT_EQ(store->count, 6u);
  EXPECT_EQ(store->modules[1].name, "pivot-1");
  EXPECT_EQ(store->modules[1].link.a, 0.45);
  EXPECT_NEAR(store->modules[0].link.alpha, std::acos(0.0), 1e-15);
  EXPECT_EQ(store->modules[5].torque, 50);
}

TEST_F(StoreTest, RefusesABadStoreWithTheLine) {
  EXPECT_EQ(refusal("# nothing\n\n"), ": there is no module in it");
  EXPECT_EQ(refusal("a 0 90 0.3 0 9 -170 170 270\nb 0 90 0.3\n"),
            ":2: expected a name and eight numbers: a alpha d theta mass low high torque");
  EXPECT_EQ(refusal("a 0 90 0.3 0 9 -170 170 270 5\n"),
            ":1: expected a name and eight numbers: a alpha d theta mass low high torque");
  EXPECT_EQ(refusal("a 0 90 0.3 0 0 -170 170 270\n"), ":1: the mass is not positive");
  EXPECT_EQ(refusal("a 0 90 0.3 0 9 170 -170 270\n"), ":1: the lower limit is not below the upper one");
  EXPECT_EQ(refusal("a 0 90 0.3 0 9 -170 170 -1\n"), ":1: the torque is not positive");
  EXPECT_EQ(refusal("a 0 90 0 0 9 -170 170 270\n"), ":1: the link has no extent: at least 1 mm of a or d");
  std::string eleven;
  for (int i = 0; i < 11; ++i) eleven += "m 0.1 0 0 0 1 -90 90 10\n";
  EXPECT_EQ(refusal(eleven), ":11: there are more than 10 modules");
  EXPECT_EQ(refusal("a 0 90 10.1 0 9 -170 170 270\n"), ":1: a and d are at most 10 m");
  EXPECT_EQ(refusal("a 0 90 1 0 1e300 -170 170 270\n"), ":1: the mass is at most 1000 kg, the torque 1e6 N.m");
  EXPECT_EQ(refusal("a 0 90 1 0 1e-300 -170 170 270\n"), ":1: the mass is at least 1 g");
  EXPECT_EQ(refusal("a 0 1e9 1 0 9 -170 170 270\n"), ":1: alpha and theta are at most 400 deg");
  EXPECT_EQ(refusal("a 0 90 1 0 9 -1e300 170 270\n"), ":1: the limits are at most 1000 rad either way");
  EXPECT_EQ(refusal(std::string(300, 'x')), ":1: the line is longer than 256 bytes");
  EXPECT_EQ(refusal(std::string(1001, '\n')), ":1001: there are more than 1000 lines");
  EXPECT_EQ(ModuleStore::read("/dev/zero").error().message.view(), "/dev/zero: is no ordinary file but a device");
  EXPECT_EQ(ModuleStore::read("no_such.store").error().message.view(), "no_such.store: cannot be read");
}

TEST_F(StoreTest, BothBuildsTellTheChainOfTheirStore) {
  for (const char* file : {"rmms_a.store", "rmms_b.store"}) {
    const Result<ModuleStore> store = ModuleStore::read(shipped(file));
    Rig rig("rmms");
    rig.resource("store", shipped(file).c_str());
    for (std::size_t i = 0; i < 10; ++i) rig.set("q_ref", 0.1, i);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    DhChain told, written;
    told.ndof = written.ndof = store->count;
    ASSERT_EQ(rig.get<std::int32_t>("ndof"), static_cast<std::int32_t>(store->count));
    for (std::size_t i = 0; i < store->count; ++i) {
      told.dh[i] = rig.get<DhLink>("dh", i);
      written.dh[i] = store->modules[i].link;
    }
    told.base = rig.get<Pose>("base");
    told.tool = rig.get<Pose>("tool");
    const std::array<double, kMostJoints> q{0.3, -0.5, 0.8, 0.2, -0.9, 0.4, 1.1};
    const Frame a = tool_frame(told, q), b = tool_frame(written, q);
    EXPECT_LT(length(a.origin - b.origin), 1e-9);
    EXPECT_LT(length(a.x - b.x), 1e-9);
    EXPECT_LT(length(a.z - b.z), 1e-9);
    ASSERT_TRUE(rig.on());
    for (int i = 0; i < 600; ++i) ASSERT_TRUE(rig.cycle());
    for (std::size_t i = 0; i < store->count; ++i) EXPECT_NEAR(rig.get<double>("q", i), 0.1, 1e-3) << file;
  }
}

TEST(Rmms, RefusesAReferenceThatIsNoNumberAndAPoseOutsideItsLimits) {
  Rig rig("rmms");
  rig.resource("store", shipped("rmms_a.store").c_str());
  for (std::size_t i = 0; i < 10; ++i) rig.set("q_ref", 0.0, i);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  rig.set("q_ref", std::nan(""), 1);
  EXPECT_EQ(rig.cycle().text, "q_ref[1] is not finite");
  EXPECT_FALSE(rig.error());
  EXPECT_TRUE(rig.clear());
  rig.set("start_pose", 9.0, 0);
  EXPECT_EQ(rig.init().text, "joint 1 at 9 rad is outside its limits -2.967 to 2.967 rad");
}

}  // namespace
}  // namespace chimera::library
