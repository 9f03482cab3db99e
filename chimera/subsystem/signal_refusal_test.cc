// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/signal_refusal.h"

#include <gtest/gtest.h>

namespace chimera::subsystem {
namespace {

const SignalRefusal kNameless{RefusalKind::kOther, {}, {}};
const SignalRefusal kIllegal{RefusalKind::kState, "pi is OFF", "type `chimera on pi`"};

TEST(SignalRefusal, PrintsItsReasonAndThenItsRemedy) {
  EXPECT_EQ(kIllegal.text(), "pi is OFF; type `chimera on pi`");
  EXPECT_EQ(SignalRefusal({RefusalKind::kFault, "no sensor", {}}).text(), "no sensor");
  EXPECT_EQ(kIllegal.behind("on sent by traj: ").text(), "on sent by traj: pi is OFF; type `chimera on pi`");
  EXPECT_EQ(kNameless.behind("on: ").text(), "") << "words before nothing say nothing";
}

TEST(SignalRefusal, ARefusedListHasTheFirstReason) {
  SignalRefusal refusal;
  EXPECT_FALSE(refusal.is_refused());
  EXPECT_TRUE(refusal.add(kNameless));
  EXPECT_TRUE(refusal.is_refused());
  EXPECT_TRUE(refusal.add(kIllegal));
  EXPECT_FALSE(refusal.add({RefusalKind::kFault, "no sensor", {}}));
  EXPECT_FALSE(refusal.add(kNameless));
  EXPECT_EQ(refusal.kind, RefusalKind::kState);
  EXPECT_EQ(refusal.reason, "pi is OFF");
}

TEST(SignalRefusal, EveryKindHasAName) {
  EXPECT_STREQ(refusal_kind_name(RefusalKind::kNone), "");
  EXPECT_STREQ(refusal_kind_name(RefusalKind::kNoAnswer), "no-answer");
  EXPECT_STREQ(refusal_kind_name(RefusalKind::kOther), "other");
}

}  // namespace
}  // namespace chimera::subsystem
