// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/watch/guard_news.h"

#include <gtest/gtest.h>

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
}

TEST_F(GuardNews, ATaskThatWasSilentAndHowTheGuardIs) {
  const auto law = static_cast<std::int32_t>(fake.task("law").index);
  EXPECT_EQ(told({.kind = Kind::kSilent, .index = 1, .code = law}),
            "law: published nothing for as long as `safe_after` says: its rtpu is ended\n");
  EXPECT_EQ(told({.kind = Kind::kSilent, .index = 1, .code = law, .letter = 1}),
            "law: published nothing for as long as `stale_after` of its standby says: its rtpu is ended\n");
  EXPECT_EQ(told({.kind = Kind::kGuardState, .code = KeeperMessage::kGuardIsSlow}),
            "the guard has no real-time rights: it writes safe frames, and nothing bounds when\n");
  EXPECT_EQ(told({.kind = Kind::kGuardState, .code = KeeperMessage::kGuardIsDead}),
            "the guard is dead: no safe frames are written until the next run\n");
}

TEST_F(GuardNews, IgnoresMessagesThatFitNoTaskOrRtpu) {
  EXPECT_EQ(told({.kind = Kind::kFramesWritten, .index = 7, .code = 2}), "");
  EXPECT_EQ(told({.kind = Kind::kSilent, .index = 1, .code = -1}), "");
  EXPECT_EQ(told({.kind = Kind::kGuardState, .code = KeeperMessage::kGuardIsWell}), "");
}

}  // namespace
}  // namespace chimera::manager::guard_news_test
