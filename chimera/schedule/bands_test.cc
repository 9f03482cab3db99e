// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/bands.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

constexpr BandMember kUnits[] = {{0, 0}, {1, 1}, {0, 2}, {0, 2}};

TEST(Bands, TheMostCriticalRtpuOfACpuStandsHighest) {
  EXPECT_EQ(band_top(kUnits, 2, 80), 80);
  EXPECT_EQ(band_top(kUnits, 3, 80), 60) << "a tie goes by the order of the description";
  EXPECT_EQ(band_top(kUnits, 0, 80), 40);
}

TEST(Bands, RtpusOfOtherCpusDoNotCount) { EXPECT_EQ(band_top(kUnits, 1, 80), 80); }

TEST(Bands, NeverGoBelowOneAndStayAwayWithoutRealTime) {
  EXPECT_EQ(band_top(kUnits, 0, 30), 1);
  EXPECT_EQ(band_top(kUnits, 2, 0), 0);
}

}  // namespace
}  // namespace chimera
