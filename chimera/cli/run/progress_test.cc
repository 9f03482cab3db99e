// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/progress.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

TEST(Progress, PrintsDoneAndRemainingRuns) {
  EXPECT_EQ(progress_text(seconds(12), seconds(60), seconds(2)),
            "12.0 of 60.0 s of virtual time (20 %), about 8 s to go");
}

TEST(Progress, GuessesNothingAtTheStartAndTheEnd) {
  EXPECT_EQ(progress_text(seconds(0), seconds(60), seconds(5)), "0.0 of 60.0 s of virtual time (0 %)");
  EXPECT_EQ(progress_text(seconds(60), seconds(60), seconds(5)), "60.0 of 60.0 s of virtual time (100 %)");
  EXPECT_EQ(progress_text(seconds(0), seconds(0), seconds(0)), "0.0 of 0.0 s of virtual time (0 %)");
}

}  // namespace
}  // namespace chimera::cli
