// SPDX-License-Identifier: Apache-2.0
#include "firmware/watch/reset_record.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>

#include "firmware/shell/shell_rows.h"

namespace chimera::firmware::reset_record_test {
namespace {

std::string text_of(const Boot& boot) {
  std::array<TaskSpec, 2> tasks{};
  tasks[0].name = "wave";
  tasks[1].name = "control";
  TextLine line;
  put_boot(line, boot, tasks);
  return std::string(line.view());
}

TEST(ResetRecord, PowerUpIsAColdBoot) {
  ResetRecord record;
  std::memset(static_cast<void*>(&record), 0xa5, sizeof record);
  EXPECT_EQ(text_of(take_up(record)), "cold boot");
  EXPECT_TRUE(is_whole(record));
}

TEST(ResetRecord, CauseIsTakenUpOnce) {
  ResetRecord record;
  (void)take_up(record);
  note_vital_fault(record, {VitalFault::kSilent, TaskId(1u), 0});
  note_end(record, ResetCause::kWatchdog, {1, CHIMERA_CYCLE}, 0x1a2b);
  EXPECT_EQ(text_of(take_up(record)),
            "warm boot 1: watchdog in cycle of task control at 0x00001a2b, silent: control");
  EXPECT_EQ(text_of(take_up(record)), "warm boot 2: no cause noted");
}

TEST(ResetRecord, FirstCauseStays) {
  ResetRecord record;
  (void)take_up(record);
  note_end(record, ResetCause::kStack, {0, CHIMERA_ON}, 4);
  note_end(record, ResetCause::kWatchdog, {}, 8);
  EXPECT_EQ(text_of(take_up(record)), "warm boot 1: stack overflow in on of task wave at 0x00000004");
}

TEST(ResetRecord, ThirdWarmBootInARowStartsOff) {
  ResetRecord record;
  EXPECT_FALSE(take_up(record).starts_off);
  EXPECT_FALSE(take_up(record).starts_off);
  EXPECT_FALSE(take_up(record).starts_off);
  const Boot third = take_up(record);
  EXPECT_TRUE(third.starts_off);
  EXPECT_EQ(text_of(third), "warm boot 3: no cause noted; no task is started");
  note_settled(record);
  EXPECT_FALSE(take_up(record).starts_off);
}

TEST(ResetRecord, IsNotBelievedWithAnyOneOrTwoBitsFlipped) {
  ResetRecord record;
  (void)take_up(record);
  note_vital_fault(record, {VitalFault::kGuard, TaskId(), 1});
  note_end(record, ResetCause::kFault, {7, CHIMERA_OFF}, 0xdeadbeef);
  ASSERT_TRUE(is_whole(record));
  std::array<std::uint32_t, sizeof record / 4> words;
  std::memcpy(words.data(), &record, sizeof record);
  constexpr std::size_t kBits = 8 * sizeof record;
  int believed = 0;
  for (std::size_t a = 0; a < kBits; ++a) {
    for (std::size_t b = a; b < kBits; ++b) {
      auto flipped = words;
      flipped[a / 32] ^= 1u << a % 32;
      if (b != a) flipped[b / 32] ^= 1u << b % 32;
      ResetRecord other;
      std::memcpy(static_cast<void*>(&other), flipped.data(), sizeof other);
      believed += is_whole(other) ? 1 : 0;
    }
  }
  EXPECT_EQ(believed, 0);
}

TEST(ResetRecord, NotesDoNotSealAnOverwrittenRecord) {
  ResetRecord record;
  (void)take_up(record);
  record.warm_boots = 77;  // a stray write
  note_end(record, ResetCause::kFault, {}, 0);
  const Boot boot = take_up(record);
  EXPECT_EQ(boot.warm_boots, 1u);
  EXPECT_EQ(boot.cause, ResetCause::kFault);
}

}  // namespace
}  // namespace chimera::firmware::reset_record_test
