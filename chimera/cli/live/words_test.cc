// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/words.h"

#include <gtest/gtest.h>

#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/testing/test_answers.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

using Words = std::vector<std::string>;

Words cut(const std::string& line) { return words_of(line).value(); }

TEST(Words, SpacesCutAndQuotesKeep) {
  EXPECT_EQ(cut("  set kp  '[100 90] N.m/rad' "), (Words{"set", "kp", "[100 90] N.m/rad"}));
  EXPECT_EQ(cut("a\"b c\"'d e' \"\" x\\ y"), (Words{"ab cd e", "", "x y"}));
  EXPECT_EQ(cut("\"say \\\"hi\\\"\" 'a\\'"), (Words{"say \"hi\"", "a\\"}));
  EXPECT_EQ(cut(""), Words{});
}

TEST(Words, ACommentBeginsWhereAWordCould) {
  EXPECT_EQ(cut("off pid # the arm falls"), (Words{"off", "pid"}));
  EXPECT_EQ(cut("# nothing"), Words{});
  EXPECT_EQ(cut("a#b '#c'"), (Words{"a#b", "#c"}));
}

TEST(Words, AnOpenQuoteIsRefused) {
  const auto words = words_of("set kp '1");
  ASSERT_FALSE(words);
  EXPECT_EQ(words.error().message.view(), "a ' is not closed");
}

Words offered(const std::string& before) {
  return completions(shell_words(), before, names_of(Json::parse(test::kDescribed)));
}

TEST(Words, CommandsAreCompletedBeforeTheirOperands) {
  EXPECT_EQ(offered("sta"), Words{"status"});
  EXPECT_EQ(offered("s"), (Words{"save", "scope", "sequence", "set", "spawn", "status", "switch"}));
  EXPECT_EQ(offered("off "), (Words{"trajectory", "pid", "arm"}));
  EXPECT_EQ(offered("ring a"), Words{"arm"});
  EXPECT_EQ(offered("on h"), Words{"hand"}) << "a configuration";
  EXPECT_EQ(offered("off h"), Words{});
  EXPECT_EQ(offered("get q"), (Words{"q", "q_ref"}));
  EXPECT_EQ(offered("get n"), Words{}) << "constants have no reading";
  EXPECT_EQ(offered("set "), Words{"kp"});
  EXPECT_EQ(offered("set kp "), Words{});
  EXPECT_EQ(offered("flag u"), Words{"up"});
  EXPECT_EQ(offered("help wh"), Words{"why"});
  EXPECT_EQ(offered("set 'k"), Words{});
  EXPECT_EQ(offered("nonsense "), Words{});
}

TEST(Words, ATabAddsTheSharedBeginning) {
  EXPECT_EQ(shared_beginning({"q", "q_ref"}), "q");
  EXPECT_EQ(shared_beginning({"status"}), "status");
  EXPECT_EQ(shared_beginning({"a", "b"}), "");
  EXPECT_EQ(shared_beginning({}), "");
}

}  // namespace
}  // namespace chimera::cli
