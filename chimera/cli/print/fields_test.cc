// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/fields.h"
#include "chimera/text/json.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

TEST(Fields, AMissingFieldOrAnotherKindGivesTheDefault) {
  const Json odd = {{"a", nullptr}, {"b", "x"}, {"c", 1.5}, {"d", 18446744073709551615u}, {"e", {1, "y"}}};
  for (const char* key : {"a", "b", "z"}) EXPECT_EQ(whole_of(odd, key), 0) << key;
  EXPECT_EQ(whole_of(odd, "c"), 1);
  EXPECT_EQ(whole_or_none(odd, "d"), std::nullopt);
  EXPECT_EQ(text_of(odd, "b"), "x");
  EXPECT_EQ(text_of(odd, "c"), "");
  EXPECT_EQ(number_of(odd, "c"), 1.5);
  EXPECT_FALSE(truth_at(odd, "c"));
  EXPECT_EQ(texts_of(odd, "e"), std::vector<std::string>{"y"});
  EXPECT_EQ(texts_of(Json(3), "e"), std::vector<std::string>{});
}

TEST(Fields, NoTextOfAnAnswerSteersTheTerminal) {
  const Json answer{{"text", "a\x1b[2Jb\n\u202e\u00b5m"}, {"texts", {"\u009b2J"}}};
  EXPECT_EQ(text_of(answer, "text"), "a [2Jb  \u00b5m");
  EXPECT_EQ(texts_of(answer, "texts"), std::vector<std::string>{" 2J"});
}

}  // namespace
}  // namespace chimera::cli
