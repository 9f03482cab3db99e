// SPDX-License-Identifier: Apache-2.0
// Safe states and safe frames in the C face (chimera/task/pbo.h).
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(CFace, ASafeStateAndASafeFrame) {
  const std::string path = "/tmp/t_brake_" + std::to_string(::getpid());
  Rig rig("t_brake");
  rig.resource("log", "none");
  rig.resource("device", path.c_str());
  ASSERT_TRUE(rig.init());
  EXPECT_GE(rig.safe_frame(1).descriptor, 0);
  EXPECT_EQ(rig.safe_frame(1).pause, microseconds(2));
  EXPECT_EQ(rig.safe_frame(1).size, 0u);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(std::string(rig.safe_frame(1).bytes, rig.safe_frame(1).bytes + rig.safe_frame(1).size), "brake");
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("braked"));
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.safe_frame(1).size, 0u) << "a device that is off is safe";
  ASSERT_TRUE(rig.kill());
  EXPECT_LT(rig.safe_frame(1).descriptor, 0);
  EXPECT_EQ(std::remove(path.c_str()), 0);
}

}  // namespace
}  // namespace chimera
