// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/watch/guard_news.h"

#include <gtest/gtest.h>

#include <cerrno>

#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager::guard_news_test {
namespace {

using Kind = KeeperMessage::Kind;

struct GuardNews : ::testing::Test {
  GuardNews() { fake.start_manager(); }
  std::string told(const KeeperMessage& message) {
    const std::string before = fake.told("safe");
    tell_of_guard(fake.loop().state(), message, now());
    return fake.told("safe").substr(before.size());
  }
  FakeSubsystem fake;
};

TEST_F(GuardNews, FramesThatWereWrittenAndThatCouldNotBe) {
  KeeperMessage message{.kind = Kind::kFramesWritten, .index = 1, .code = 2, .at = milliseconds(5)};
  message.silent = milliseconds(5) - microseconds(72);
  EXPECT_EQ(told(message), "2 safe frames written, the last byte 0.072 ms after the guard saw the death\n");
  message.code = 1;
  message.letter = 1;
  EXPECT_EQ(told(message), "1 safe frame written, the last byte 0.072 ms after the guard saw the death; 1 COULD NOT BE "
                           "WRITTEN: the device took nothing for 1 s\n");
  message.code = 0;
  EXPECT_EQ(told(message), "0 safe frames written; 1 COULD NOT BE WRITTEN: the device took nothing for 1 s\n");
  message.letter = 0;
  EXPECT_EQ(told(message), "") << "an rtpu without frames is no news";
  message.late = 2;
  EXPECT_EQ(told(message),
            "0 safe frames written; 2 left out: the guard was late, its restarted rtpu drives the device\n");
}

TEST_F(GuardNews, ATaskThatWasSilent) {
  const auto law = static_cast<std::int32_t>(fake.task("law").index);
  EXPECT_EQ(told({.kind = Kind::kSilent, .index = 1, .code = law}),
            "law: published nothing for as long as `safe_after` says: its rtpu is ended\n");
  EXPECT_EQ(told({.kind = Kind::kSilent, .index = 1, .code = law, .letter = 1}),
            "law: published nothing for as long as `stale_after` of its standby says: its rtpu is ended\n");
}

TEST_F(GuardNews, ReportsTheStateOfTheGuardOnceInEachManager) {
  const std::string late = "the guard lacks real-time priority or locked memory: it may write safe frames late\n",
                    dead = "the guard is dead: no safe frames are written until the next run\n";
  EXPECT_EQ(guard_json(fake.loop().state()), Json()) << "no task has a device";
  fake.page().guard_pid = 4711;
  fake.step();
  EXPECT_EQ(fake.told("safe"), "");
  EXPECT_EQ(guard_json(fake.loop().state()).dump(), R"({"hang":null,"lack":null,"pid":4711})");
  fake.page().guard_state = GuardState::kLate;
  fake.step();
  fake.step();
  EXPECT_EQ(fake.told("safe"), late);
  fake.page().guard_state = GuardState::kDead;
  fake.page().guard_pid = 0;
  fake.step();
  EXPECT_EQ(fake.told("safe"), late + dead);
  EXPECT_NE(guard_json(fake.loop().state()).dump().find("the guard is dead"), std::string::npos);
  fake.kill_manager();
  fake.start_manager();
  fake.step();
  EXPECT_EQ(fake.told("safe"), dead);
}

TEST_F(GuardNews, ReportsAnRtpuWithoutAGuardWithReasonAndRemedy) {
  fake.page().guard_pid = 4711;
  fake.page().unguarded[1] = EMFILE;
  fake.step();
  fake.step();
  EXPECT_EQ(fake.told("safe"),
            "no safe frame can be written: Too many open files; raise the limits of open files (ulimit -n) and locked "
            "memory (ulimit -l), and start the run again\n");
  EXPECT_EQ(fake.loop().state().log.at(fake.loop().state().log.last()).rtpu, RtpuId(1u));
  EXPECT_EQ(no_guard(fake.loop().state(), RtpuId(0u)).why, "");
  EXPECT_EQ(no_guard(fake.loop().state(), RtpuId(1u)).why, "no safe frame can be written: Too many open files");
  fake.page().unguarded[1] = 0;  // restarted
  fake.step();
  fake.page().unguarded[1] = EAGAIN;
  fake.step();
  EXPECT_NE(fake.told("safe").find("written: Resource temporarily unavailable; raise"), std::string::npos);
}

TEST_F(GuardNews, IgnoresMessagesThatFitNoTaskOrRtpu) {
  EXPECT_EQ(told({.kind = Kind::kFramesWritten, .index = 7, .code = 2}), "");
  EXPECT_EQ(told({.kind = Kind::kSilent, .index = 1, .code = -1}), "");
}

}  // namespace
}  // namespace chimera::manager::guard_news_test
