// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/figures.h"

#include <gtest/gtest.h>

#include <limits>

namespace chimera::cli {
namespace {

TEST(Figures, DurationsHaveThreeDigitsAndTheirUnit) {
  EXPECT_EQ(duration_text(std::nullopt), "-");
  EXPECT_EQ(duration_text(0), "0 ns");
  EXPECT_EQ(duration_text(999), "999 ns");
  EXPECT_EQ(duration_text(1'000), "1.00 us");
  EXPECT_EQ(duration_text(12'345), "12.3 us");
  EXPECT_EQ(duration_text(999'499), "999 us");
  EXPECT_EQ(duration_text(999'500), "1.00 ms");
  EXPECT_EQ(duration_text(45'120'000'000), "45.1 s");
  EXPECT_EQ(duration_text(750'000'000'000), "12.5 min");
  EXPECT_EQ(duration_text(12'240'000'000'000), "204 min");
  EXPECT_EQ(duration_text(360'000'000'000'000), "100 h");
  EXPECT_EQ(duration_text(-1'500'000), "-1.50 ms");
}

TEST(Figures, DurationsStayNarrowUpToADecade) {
  for (double ns = 1; ns < 3e17; ns *= 1.07)
    EXPECT_LE(duration_text(static_cast<std::int64_t>(ns)).size(), 8u) << ns;
}

TEST(Figures, RatesAndCounts) {
  EXPECT_EQ(rate_text(0), "-");
  EXPECT_EQ(rate_text(1000), "1 kHz");
  EXPECT_EQ(rate_text(998.4), "998 Hz");
  EXPECT_EQ(rate_text(62.5), "62.5 Hz");
  EXPECT_EQ(rate_text(2e6), "2 MHz");
  EXPECT_EQ(count_text(99'999), "99999");
  EXPECT_EQ(count_text(100'000), "100k");
  EXPECT_EQ(count_text(1'234'567), "1.23M");
  EXPECT_EQ(count_text(std::numeric_limits<std::int64_t>::max()), "9.22E");
}

}  // namespace
}  // namespace chimera::cli
