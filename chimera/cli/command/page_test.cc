// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/command/page.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

const Command kNew{.name = "new", .help = "Make one", .json = nullptr, .has_commands = true};
const Command kApp{.name = "new app", .help = "An app", .operands = "NAME", .least = 1, .most = 1, .json = nullptr};
const Command kDraw{.name = "draw",
                    .help = "Draw it",
                    .operands = "FILE",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kDescription,
                    .options = {{.name = "--as",
                                 .value = "FORMAT",
                                 .help = "how",
                                 .manual = "'svg', or `dot`.",
                                 .kind = WordKind::kOneOf,
                                 .words = "dot svg"},
                                {.name = "--fast", .help = "at once"},
                                {.name = "--to", .value = "PLACE", .help = "where", .is_required = true}},
                    .json = "as JSON",
                    .which = "which one",
                    .manual = ".5 s at most; a\\b"};
const Command kHidden{.name = "pages", .help = "no", .json = nullptr, .is_hidden = true};
const Command kQuit{.name = "quit", .help = "no", .json = nullptr, .is_shells = true};
const Command* const kTable[] = {&kNew, &kApp, &kDraw, &kHidden, &kQuit};

std::string made(const std::string& part) { return page(part, kTable).value(); }

TEST(Page, OtherLinesStayAsTheyAre) { EXPECT_EQ(made("a\n\n.B b @words@\n"), "a\n\n.B b @words@\n"); }

TEST(Page, RefusesAnUnknownPart) {
  const auto refused = page("a\n@word@\n", kTable);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where.view(), "@word@");
}

TEST(Page, SynopsisHasOperandsAndRequiredOptions) {
  EXPECT_EQ(
      made("@synopsis@"),
      ".br\n.B chimera new app\n\\fINAME\\fR\n"
      ".br\n.B chimera draw\n\\fIFILE\\fR \\fB\\-\\-to\\fR \\fIPLACE\\fR [\\fIOPTION\\fR]... [\\fB\\-\\-json\\fR] "
      "[\\fB\\-\\-subsystem\\fR \\fINAME\\fR]\n");
}

TEST(Page, NoTextIsTakenForAMacroOfRoff) {
  EXPECT_EQ(made("@commands@"),
            ".SS new\nMake one.\n.TP\n.B \\-\\-help\nThe usage of this command.\n"
            ".SS new app\nAn app.\n.TP\n.B \\-\\-help\nThe usage of this command.\n"
            ".SS draw\n\\&.5 s at most; a\\eb\n.TP\n.B \\-\\-help\nThe usage of this command.\n"
            ".TP\n.BI \\-\\-as \" FORMAT\"\n\\&'svg', or \\fBdot\\fR.\n"
            ".TP\n.B \\-\\-fast\nAt once.\n"
            ".TP\n.BI \\-\\-to \" PLACE\"\nWhere.\n"
            ".TP\n.B \\-\\-json\nThe raw answer, as docs/formats/control.md has it.\n"
            ".TP\n.BI \\-\\-subsystem \" NAME\"\nWhich one.\n");
}

TEST(Page, WordsOfEveryCommandButHiddenOnes) {
  EXPECT_EQ(made("@words@"),
            "    '') echo '--help --version --json --subsystem new draw' ;;\n"
            "    'new') echo '--help app' ;;\n"
            "    'new app') echo '--help' ;;\n"
            "    'draw') echo '--help --as --fast --to --json --subsystem' ;;\n");
}

TEST(Page, EveryOperandAndOptionNamesItsKindOfValue) {
  EXPECT_EQ(made("@takes@"),
            "    ' --subsystem') echo 'text' ;;\n"
            "    'new') echo 'command' ;;\n"
            "    'new app') echo 'text' ;;\n"
            "    'draw') echo 'description' ;;\n"
            "    'draw --as') echo 'words dot svg' ;;\n"
            "    'draw --to') echo 'text' ;;\n"
            "    'draw --subsystem') echo 'text' ;;\n");
}

}  // namespace
}  // namespace chimera::cli
