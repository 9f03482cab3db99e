// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/act/drill.h"

#include <gtest/gtest.h>

#include <csignal>

#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

struct DrillTest : ::testing::Test {
  DrillTest() {
    fake.rtpu(0).filled_with = 0;
    fake.start_manager();
    EXPECT_TRUE(fake.until_on("arm"));
    EXPECT_TRUE(fake.until_on("log"));
  }
  void begin(Nanoseconds wait, RtpuId to_kill = {}) {
    got.reset();
    fake.loop().drill().begin(wait, to_kill, now(), [this](const DrillOutcome& outcome) { got = outcome; });
  }
  bool until_over() {
    return fake.until([this] { return got.has_value(); });
  }
  std::uint32_t flag() { return fake.loop().state().own.block().head().flag; }
  std::string flag_text() { return flag_json(fake.loop().state()).dump(); }

  FakeSubsystem fake{kHardwareText};
  std::optional<DrillOutcome> got;
};

TEST_F(DrillTest, HardwareIsATaskWithASafeStateOrAMovingResource) {
  const auto hardware = hardware_of(fake.spec(), fake.loop().state().bundle.library);
  ASSERT_EQ(hardware.size(), 2u);
  EXPECT_EQ(hardware[0].task, fake.task("arm"));
  EXPECT_EQ(hardware[0].verdict, DrillVerdict::kWaiting);
  EXPECT_EQ(hardware[0].output, 1u);
  EXPECT_EQ(hardware[1].task, fake.task("winch"));
  EXPECT_EQ(hardware[1].verdict, DrillVerdict::kCannotTell);
}

TEST_F(DrillTest, RaisesTheFlagUntilTheDeviceIsSafeAndReportsTheTime) {
  begin(kHangLimit);
  EXPECT_EQ(flag(), kDrillFlag);
  EXPECT_EQ(flag_text(), R"({"by":["drill"],"up":true})");
  EXPECT_TRUE(fake.until([&] { return fake.rtpu(0).block().profile(fake.task("arm")).cycles > 3; }));
  EXPECT_FALSE(got) << "it has not said that it is safe";
  fake.rtpu(0).filled_with = 1;
  ASSERT_TRUE(until_over());
  EXPECT_EQ(flag(), 0u);
  ASSERT_EQ(got->tasks.size(), 1u) << "winch is OFF, log never moves";
  EXPECT_EQ(got->tasks[0].verdict, DrillVerdict::kSafe);
  EXPECT_GT(got->tasks[0].after, Nanoseconds{});
  EXPECT_LE(got->tasks[0].after, got->flag_for);
  EXPECT_TRUE(got->is_safe());
  EXPECT_FALSE(fake.loop().drill().is_under_way());
  const std::string told = fake.told("drill");
  EXPECT_NE(told.find("the drill raised the flag\narm: safe "), std::string::npos) << told;
  EXPECT_NE(told.find("the drill lowered the flag after "), std::string::npos) << told;
}

TEST_F(DrillTest, IgnoresValuesFromBeforeTheFlag) {
  fake.rtpu(0).filled_with = 1;
  const std::uint64_t cycles = fake.rtpu(0).block().profile(fake.task("arm")).cycles;
  ASSERT_TRUE(fake.until([&] { return fake.rtpu(0).block().profile(fake.task("arm")).cycles > cycles + 1; }));
  fake.rtpu(0).die();  // its last words stand
  begin(milliseconds(50));
  ASSERT_TRUE(until_over());
  EXPECT_EQ(got->tasks[0].verdict, DrillVerdict::kWaiting);
  EXPECT_FALSE(got->is_safe());
}

TEST_F(DrillTest, LowersTheFlagWhenTheTimeIsOver) {
  begin(milliseconds(20));
  ASSERT_TRUE(until_over());
  EXPECT_EQ(got->tasks[0].verdict, DrillVerdict::kWaiting);
  EXPECT_GE(got->flag_for, milliseconds(20));
  EXPECT_EQ(flag(), 0u);
  EXPECT_FALSE(got->is_safe());
}

TEST_F(DrillTest, ATaskThatDiesIsNotSafe) {
  begin(kHangLimit);
  fake.kill_rtpu(0, SIGKILL);
  ASSERT_TRUE(until_over());
  EXPECT_EQ(got->tasks[0].verdict, DrillVerdict::kLeft);
  EXPECT_FALSE(got->is_safe());
}

TEST_F(DrillTest, TheOperatorsPartOfTheFlagIsNotTouched) {
  fake.loop().state().own.block().head().flag = kOperatorFlag;
  begin(milliseconds(5));
  EXPECT_EQ(flag(), kDrillFlag | kOperatorFlag);
  ASSERT_TRUE(until_over());
  EXPECT_EQ(flag(), kOperatorFlag);
}

TEST_F(DrillTest, AManagerThatDiesEndsItsDrill) {
  begin(kHangLimit);
  fake.kill_manager();
  fake.start_manager();
  EXPECT_EQ(flag(), 0u);
}

TEST_F(DrillTest, KillsAnRtpuWhenAllAreSafeAndReportsTheFramesOfTheGuard) {
  fake.rtpu(0).filled_with = 1;
  begin(kHangLimit, RtpuId(std::size_t{0}));
  ASSERT_TRUE(fake.until([&] { return fake.killed == 0u; }));
  EXPECT_FALSE(got) << "the guard has said nothing";
  KeeperMessage written{.kind = KeeperMessage::Kind::kFramesWritten, .index = 1, .code = 1, .at = now()};
  fake.loop().drill().take(written);  // of another rtpu
  fake.step();
  EXPECT_FALSE(got);
  written.index = 0;
  written.at = now();
  fake.loop().drill().take(written);
  ASSERT_TRUE(until_over());
  EXPECT_EQ(got->tasks[0].verdict, DrillVerdict::kSafe);
  EXPECT_TRUE(got->killed.is_told);
  EXPECT_EQ(got->killed.good, 1u);
  EXPECT_GT(got->killed.after, Nanoseconds{});
  EXPECT_TRUE(got->is_safe());
}

TEST_F(DrillTest, AnRtpuThatHadNoSafeFrameIsNotSafe) {
  fake.rtpu(0).filled_with = 1;
  begin(kHangLimit, RtpuId(std::size_t{0}));
  ASSERT_TRUE(fake.until([&] { return fake.killed == 0u; }));
  fake.loop().drill().take({.kind = KeeperMessage::Kind::kFramesWritten, .index = 0});
  ASSERT_TRUE(until_over());
  EXPECT_TRUE(got->killed.is_told);
  EXPECT_FALSE(got->is_safe());
}

TEST_F(DrillTest, AGuardThatSaysNothingIsNotWaitedForForEver) {
  fake.rtpu(0).filled_with = 1;
  begin(milliseconds(500), RtpuId(std::size_t{0}));
  ASSERT_TRUE(until_over());
  EXPECT_FALSE(got->killed.is_told);
  EXPECT_FALSE(got->is_safe());
}

TEST(Drill, WithoutHardwareNothingIsSafe) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  std::optional<DrillOutcome> got;
  fake.loop().drill().begin(kHangLimit, RtpuId{}, now(), [&](const DrillOutcome& outcome) { got = outcome; });
  ASSERT_TRUE(got);
  EXPECT_TRUE(got->tasks.empty());
  EXPECT_FALSE(got->is_safe());
}

TEST(Drill, HardwareWithoutSafeStateIsNotAwaitedAndNotSafe) {
  std::string text = kHardwareText;
  text.replace(text.find("start: run"), 10, "start: all");
  FakeSubsystem fake(text);
  fake.rtpu(0).filled_with = 1;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("winch") && fake.until_on("arm"));
  std::optional<DrillOutcome> got;
  fake.loop().drill().begin(kHangLimit, RtpuId{}, now(), [&](const DrillOutcome& outcome) { got = outcome; });
  ASSERT_TRUE(fake.until([&] { return got.has_value(); }));
  ASSERT_EQ(got->tasks.size(), 2u);
  EXPECT_EQ(got->tasks[0].verdict, DrillVerdict::kSafe);
  EXPECT_EQ(got->tasks[1].verdict, DrillVerdict::kCannotTell);
  EXPECT_FALSE(got->is_safe());
}

}  // namespace
}  // namespace chimera::manager
