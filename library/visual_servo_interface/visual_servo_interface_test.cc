// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <string>

#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {
namespace {

// In front of the robot, looking back along x.
constexpr Pose kCamera{{2.0, 0, 0.5}, {0.5, 0.5, -0.5, -0.5}};
constexpr Nanoseconds kStep = milliseconds(10);

struct VisionTest : ::testing::Test {
  Rig camera{"camera_targets"}, servo{"visual_servo_interface"};
  std::string link = "unix:@vision_" + std::to_string(::getpid());

  void start(double gain) {
    for (Rig* rig : {&camera, &servo}) {
      rig->set("camera", kCamera);
      rig->resource("link", link.c_str());
    }
    const double centre[3] = {0.6, 0, 0.5};
    for (std::size_t i = 0; i < 3; ++i) camera.set("centre", centre[i], i);
    camera.set("amplitude", 0.1, 1);
    camera.set("frequency", 0.25, 1);
    servo.set("gain", gain);
    servo.set("xm", Pose{{0.5, 0.2, 0.4}, {1, 0, 0, 0}});
    const RigAnswer reads = servo.init();
    ASSERT_TRUE(reads) << reads.text;
    ASSERT_TRUE(camera.init());
    ASSERT_TRUE(servo.on());
    ASSERT_TRUE(camera.on());
  }
  /// Runs a camera with 100/3 pictures a second and a servo with 100 cycles a second. Returns the final distance of xd
  /// from the ball.
  double follow(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      if (i % 3 == 0) {
        EXPECT_TRUE(camera.cycle(Nanoseconds{3 * kStep.count}));
        camera.background();
      }
      servo.background();
      EXPECT_TRUE(servo.cycle(kStep));
    }
    const Pose xd = servo.get<Pose>("xd");
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) square += std::pow(xd.position[i] - camera.get<double>("ball", i), 2);
    return std::sqrt(square);
  }
};

TEST_F(VisionTest, FollowsABallThatMoves) {
  start(5);
  EXPECT_LT(follow(301), 0.01);
  EXPECT_TRUE(servo.get<bool>("in_sight"));
  EXPECT_TRUE(camera.get<bool>("in_sight"));
  EXPECT_EQ(servo.get<std::int64_t>("received"), 101);
  EXPECT_EQ(camera.get<std::int64_t>("sent"), 101);
}

TEST_F(VisionTest, StartsAtTheHandedOverReference) {
  start(0);
  servo.set("xd", Pose{{0.6, 0.2, 0.4}, {1, 0, 0, 0}});
  servo.inherit("xd", milliseconds(20), milliseconds(10));
  ASSERT_TRUE(servo.on());
  EXPECT_EQ(servo.get<Pose>("xd").position[0], 0.6);
  servo.inherit("xd", milliseconds(21), milliseconds(10));
  ASSERT_TRUE(servo.on());
  EXPECT_EQ(servo.get<Pose>("xd").position[0], 0.5) << "where the tool is";
}

TEST_F(VisionTest, WithoutGainItStaysWhereTheToolWas) {
  start(0);
  EXPECT_GT(follow(300), 0.1);
  EXPECT_EQ(servo.get<Pose>("xd").position[0], 0.5);
}

TEST_F(VisionTest, StandsStillWhenTheCameraIsSilent) {
  start(5);
  follow(100);
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(servo.cycle(kStep));
  EXPECT_FALSE(servo.get<bool>("in_sight"));
  const double held = servo.get<Pose>("xd").position[1];
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(servo.cycle(kStep));
  EXPECT_EQ(servo.get<Pose>("xd").position[1], held);
}

TEST_F(VisionTest, MovesNoFasterThanItsLimit) {
  servo.set("speed_limit", 0.05);
  start(50);
  double before = servo.get<Pose>("xd").position[1];
  for (int i = 0; i < 50; ++i) {
    follow(1);
    const double now = servo.get<Pose>("xd").position[1];
    EXPECT_LE(std::abs(now - before), 0.05 * 0.01 + 1e-12);
    before = now;
  }
}

TEST_F(VisionTest, ABallOutOfThePictureSendsNothing) {
  camera.set("amplitude", 5.0, 2);
  camera.set("frequency", 1.0, 2);
  start(5);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(camera.cycle(milliseconds(25)));
  EXPECT_FALSE(camera.get<bool>("in_sight"));
  EXPECT_EQ(camera.get<double>("feature", 2), 0);
}

TEST(VisualServoInterface, RefusesAnInvalidLinkOrCameraPose) {
  Rig rig("visual_servo_interface");
  rig.set("camera", kCamera);
  rig.resource("link", "camera");
  EXPECT_EQ(rig.init().text, "camera: expected udp:ADDRESS:PORT, unix:PATH, here:NAME or file:PATH");
  rig.set("camera", Pose{{0, 0, 0}, {0, 0, 0, 0}});
  EXPECT_EQ(rig.init().text, "camera: the orientation is no unit quaternion");
}

TEST(PoseMonitor, JudgesAfterItHasSettled) {
  Rig rig("pose_monitor");
  rig.set("settle", 0.05);
  rig.set("target", Pose{{1, 0, 0}, {1, 0, 0, 0}});
  rig.set("xm", Pose{{0, 0, 0}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(rig.cycle(kStep));
  EXPECT_EQ(rig.get<double>("max_distance"), 1e9);
  rig.set("xm", Pose{{0.9, 0, 0}, {0.8, 0.6, 0, 0}});
  ASSERT_TRUE(rig.cycle(kStep));
  EXPECT_NEAR(rig.get<double>("max_distance"), 0.1, 1e-12);
  EXPECT_NEAR(rig.get<double>("max_angle"), 2 * std::acos(0.8), 1e-12);
  EXPECT_NEAR(rig.get<double>("tool_moved"), 0.9, 1e-12);
  rig.set("target", Pose{{0.9, 0.2, 0}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.cycle(kStep));
  EXPECT_NEAR(rig.get<double>("max_distance"), 0.2, 1e-12);
  EXPECT_NEAR(rig.get<double>("target_moved"), std::sqrt(0.05), 1e-12);
  rig.set("xm", Pose{{std::nan(""), 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.cycle(kStep).text, "a pose is not a number");
}

TEST(VisualServoInterface, DoesNotBeginWhereTheToolIsNot) {
  Rig rig("visual_servo_interface");
  rig.set("camera", kCamera);
  rig.resource("link", "unix:@chimera_nowhere_test");
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.on().text, "xm was never written: where the tool is is not known");
  rig.set("xm", Pose{{std::nan(""), 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.on().text, "xm is not a number");
}

TEST(CameraTargets, RefusesAnInvalidLinkOrCameraPose) {
  Rig rig("camera_targets");
  rig.set("camera", kCamera);
  for (std::size_t i = 0; i < 3; ++i) rig.set("centre", 0.0, i);
  rig.resource("link", "camera");
  EXPECT_EQ(rig.init().text, "camera: expected udp:ADDRESS:PORT, unix:PATH, here:NAME or file:PATH");
  rig.set("camera", Pose{{0, 0, 0}, {0, 0, 0, 0}});
  EXPECT_EQ(rig.init().text, "camera: the orientation is no unit quaternion");
  rig.set("camera", Pose{{0, std::nan(""), 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.init().text, "camera: the position is not finite");
  rig.set("camera", kCamera);
  rig.set("centre", std::nan(""), 1);
  EXPECT_EQ(rig.init().text, "centre and phase must be finite");
}

TEST(PoseMonitor, RefusesToJudgeUnwrittenPoses) {
  Rig rig("pose_monitor");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  rig.set("xm", Pose{{0, 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.cycle(kStep).status, CHIMERA_ABORTED) << "never written";
}

}  // namespace
}  // namespace chimera
