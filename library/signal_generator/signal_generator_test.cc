// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct SignalGeneratorTest : ::testing::Test {
  SignalRig rig{"signal_generator"};
  void give(const char* wave) {
    rig.set("wave", Text<16>(wave));
    rig.set("amplitude", 2.0);
    rig.set("offset", 0.5);
    rig.set("frequency", 5.0);
    rig.set("phase", 0.0);
    rig.set("end_frequency", 50.0);
    rig.set("duration", 2.0);
    rig.set("delay", 0.0);
    rig.set("seed", std::int64_t{3});
  }
  void start(const char* wave) {
    give(wave);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  double next() { return rig.cycle() ? rig.get<double>("y") : std::nan(""); }
};

TEST_F(SignalGeneratorTest, MakesASineOfItsAmplitudeFrequencyAndPhase) {
  give("sine");
  rig.set("phase", 1.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(rig.get<double>("y"), 0.5 + 2 * std::sin(1.0), 1e-12);
  for (int k = 1; k < 1000; ++k)
    ASSERT_NEAR(next(), 0.5 + 2 * std::sin(2 * std::numbers::pi * 5 * k * 1e-3 + 1), 1e-11);
}

TEST_F(SignalGeneratorTest, LosesNoPhaseInADay) {
  start("sine");
  ASSERT_TRUE(rig.cycle(seconds(86400)));
  ASSERT_TRUE(rig.cycle(milliseconds(50)));
  EXPECT_NEAR(rig.get<double>("y"), 2.5, 1e-8);
}

TEST_F(SignalGeneratorTest, SweepsItsChirp) {
  start("chirp");
  for (int k = 1; k < 2000; ++k) {
    const double t = k * 1e-3;
    ASSERT_NEAR(next(), 0.5 + 2 * std::sin(2 * std::numbers::pi * (5 * t + 45 * t * t / 4)), 1e-10) << k;
  }
}

TEST_F(SignalGeneratorTest, StepsAfterItsDelay) {
  give("step");
  rig.set("delay", 0.01);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("y"), 0.5);
  for (int k = 1; k < 10; ++k) EXPECT_EQ(next(), 0.5);
  EXPECT_EQ(next(), 2.5);
}

TEST_F(SignalGeneratorTest, RepeatsItsNoiseFromOn) {
  start("noise");
  std::vector<double> first;
  for (int k = 0; k < 100; ++k) first.push_back(next());
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  for (double value : first) EXPECT_EQ(next(), value);
  EXPECT_NE(first[0], first[1]);
}

TEST_F(SignalGeneratorTest, RefusesImpossibleConstants) {
  give("sinus");
  EXPECT_EQ(rig.init().text, "wave must be sine, square, triangle, sawtooth, chirp, noise or step");
  give("sine");
  rig.set("amplitude", std::nan(""));
  EXPECT_EQ(rig.init().text, "amplitude, offset and phase must be finite");
  give("sine");
  rig.set("frequency", -1.0);
  EXPECT_EQ(rig.init().text, "frequencies must be 0 to 1000000 Hz");
  give("chirp");
  rig.set("duration", 0.0);
  EXPECT_EQ(rig.init().text, "duration must be 0.000001 to 86400 s, and delay 0 to 86400 s");
}

}  // namespace
}  // namespace chimera
