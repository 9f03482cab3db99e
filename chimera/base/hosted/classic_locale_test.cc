// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/hosted/classic_locale.h"

#include <gtest/gtest.h>

#include <sstream>

namespace chimera::classic_locale_test {
namespace {

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

double read(const std::string& text) {
  std::istringstream words(text);
  double value = 0;
  words >> value;
  return value;
}

TEST(ClassicLocale, HasADecimalPointAndRestoresWhatWasSet) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  EXPECT_EQ(read("1.5"), 1);
  {
    const ClassicLocale decimal_point;
    EXPECT_EQ(read("1.5"), 1.5);
  }
  EXPECT_EQ(read("1,5"), 1.5);
  std::locale::global(before);
}

}  // namespace
}  // namespace chimera::classic_locale_test
