// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/cycle/script.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera {
namespace {

constexpr std::array<ScriptAct, 3> kActs = {
    ScriptAct{milliseconds(1), ScriptAct::Kind::kSignal, Signal::kOn, TaskId(0u)},
    ScriptAct{milliseconds(5), ScriptAct::Kind::kRaiseFlag, Signal::kOn, TaskId()},
    ScriptAct{milliseconds(5), ScriptAct::Kind::kSignal, Signal::kOff, TaskId(1u)}};

TEST(Script, GivesEachActOnceWhenItsTimeHasCome) {
  Script script(kActs);
  EXPECT_EQ(script.take(microseconds(999)), nullptr);
  EXPECT_EQ(script.take(milliseconds(1)), &kActs[0]);
  EXPECT_EQ(script.take(milliseconds(4)), nullptr);
  EXPECT_EQ(script.next_at(), milliseconds(5));
  EXPECT_EQ(script.take(milliseconds(9)), &kActs[1]);
  EXPECT_EQ(script.take(milliseconds(9)), &kActs[2]);
  EXPECT_EQ(script.take(kNever - Nanoseconds{1}), nullptr);
  EXPECT_EQ(script.next_at(), kNever);
}

TEST(Script, WithoutActsIsNeverDue) { EXPECT_EQ(Script().next_at(), kNever); }

TEST(ScriptDeathTest, RefusesActsOutOfOrder) {
  const std::array<ScriptAct, 2> wrong = {kActs[1], kActs[0]};
  EXPECT_DEATH(Script{wrong}, "acts\\[i - 1\\]\\.at <= acts\\[i\\]\\.at");
}

}  // namespace
}  // namespace chimera
