// SPDX-License-Identifier: Apache-2.0
#include "chimera/text/not_off.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(NotOff, PrintsAFaultWithItsMethodAndConsequence) {
  EXPECT_EQ(not_off_text(Method::kOff, "no answer"), "off failed: no answer: its hardware may not be off");
  EXPECT_EQ(not_off_text(Method::kKill, "no answer"),
            "kill failed: no answer: its hardware may not be off or released");
}

TEST(NotOff, PrintsADeathWithItsCause) {
  EXPECT_EQ(not_off_text("u ended by signal 9 (SIGKILL) in a.off"),
            "u ended by signal 9 (SIGKILL) in a.off: its hardware may not be off");
}

TEST(NotOff, OffAndKillTurnOff) {
  EXPECT_TRUE(turns_off(Method::kOff));
  EXPECT_TRUE(turns_off(Method::kKill));
  EXPECT_FALSE(turns_off(Method::kError));
}

}  // namespace
}  // namespace chimera
