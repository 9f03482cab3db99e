// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/command/command.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera::cli::command_test {
namespace {

using Repeats = Option::Repeats;
using Texts = std::vector<std::string>;

const Command kNew{.name = "new", .help = "Make one", .json = nullptr, .has_commands = true};
const Command kApp{.name = "new app", .help = "An app", .operands = "NAME", .least = 1, .most = 1, .json = nullptr};
const Command kDraw{.name = "draw",
                    .help = "Draw it",
                    .operands = "FILE",
                    .least = 1,
                    .most = 1,
                    .operand_help = "the drawing",
                    .options = {{.name = "--as", .value = "FORMAT", .kind = WordKind::kOneOf, .words = "dot svg"},
                                {.name = "--fast", .help = "at once", .letter = "-f"},
                                {.name = "--set", .value = "VAR VALUE", .repeats = Repeats::kOneEach},
                                {.name = "--names", .value = "LIST", .repeats = Repeats::kManyEach, .separator = ','},
                                {.name = "--size", .value = "N", .kind = WordKind::kNumber, .least = 1, .most = 9},
                                {.name = "--seed", .value = "N", .kind = WordKind::kNumber, .excludes = "--fast"},
                                {.name = "--to", .value = "FILE", .kind = WordKind::kFile}},
                    .json = "as JSON",
                    .which = "which one",
                    .footer = "That is all.",
                    .example = "chimera draw a.yaml\nchimera draw b.yaml --fast"};
const Command kPick{.name = "pick",
                    .help = "Pick some",
                    .operands = "[SET]",
                    .most = 1,
                    .options = {{.name = "--on", .value = "TASK...", .repeats = Repeats::kManyEach, .excludes = "SET"},
                                {.name = "--by", .value = "HOW", .is_required = true}},
                    .json = nullptr,
                    .example = "chimera pick --by hand"};
const Command kSet{.name = "set",
                   .help = "Set it",
                   .operands = "VAR VALUE",
                   .least = 2,
                   .most = kAnyNumber,
                   .operand_kind = WordKind::kSetting,
                   .json = nullptr};
const Command kVersion{.name = "--version", .help = "no", .json = nullptr, .is_hidden = true};
const Command* const kTable[] = {&kNew, &kApp, &kDraw, &kPick, &kSet, &kVersion};

CallReading read(const Texts& words) { return read_call(kTable, words, "chimera"); }
Call call_of(const Texts& words) {
  const CallReading reading = read(words);
  EXPECT_EQ(reading.fault, "");
  return reading.call;
}
/// The first line of the fault.
std::string fault(const Texts& words) {
  const std::string text = read(words).fault;
  return text.substr(0, text.find('\n'));
}

TEST(ReadCall, ReadsValuesBehindABlankOrAnEqualsSign) {
  EXPECT_EQ(call_of({"draw", "a", "--size", "3"}).value("--size"), "3");
  EXPECT_EQ(call_of({"draw", "--size=3", "a"}).operands, Texts{"a"});
  EXPECT_EQ(call_of({"draw", "a", "--set", "x", "-1", "--set=y", "--z"}).values("--set"),
            (Texts{"x", "-1", "y", "--z"}));
  EXPECT_EQ(call_of({"draw", "a", "--to=b=c"}).value("--to"), "b=c");
  EXPECT_TRUE(call_of({"draw", "a", "-f"}).has("--fast"));
}

TEST(ReadCall, AListTakesWordsUpToTheNextOption) {
  EXPECT_EQ(call_of({"draw", "a", "--names", "b,c", "-5", "d", "-f"}).values("--names"), (Texts{"b", "c", "-5", "d"}));
  EXPECT_EQ(call_of({"draw", "--names", "b", "c", "a"}).operands, Texts{"a"}) << "FILE is still missing";
  EXPECT_EQ(call_of({"draw", "--names", "b", "--", "-f"}).operands, Texts{"-f"});
  EXPECT_EQ(fault({"draw", "--names", "b", "a", "--fast"}), "FILE is required");
}

TEST(ReadCall, NegativeNumbersAndALoneDashAreNoOptions) {
  EXPECT_EQ(call_of({"set", "x", "-5", "-.5", "-inf", "-"}).operands, (Texts{"x", "-5", "-.5", "-inf", "-"}));
  EXPECT_EQ(fault({"set", "x", "-y"}), "chimera set has no option '-y'");
}

TEST(ReadCall, OptionsBeforeTheCommandBelongToIt) {
  EXPECT_TRUE(call_of({"--json", "draw", "a"}).json);
  EXPECT_EQ(call_of({"--subsystem", "s", "draw", "a"}).value("--subsystem"), "s");
  EXPECT_EQ(call_of({"--subsystem=s", "draw", "a", "--subsystem", "t"}).values("--subsystem"), Texts{"t"});
  EXPECT_EQ(fault({"--json", "new", "app", "a"}), "chimera new app has no option '--json'");
  EXPECT_EQ(fault({"--jsn", "draw"}),
            "chimera has no option '--jsn'; did you mean '--json'?; `chimera --help` lists them");
  EXPECT_EQ(call_of({"--version"}).command, &kVersion);
}

TEST(ReadCall, RefusesWithPlaceAndRemedy) {
  EXPECT_EQ(fault({}), "no command is given; `chimera --help` lists them");
  EXPECT_EQ(fault({"drew"}), "no command 'drew'; did you mean 'draw'?; `chimera --help` lists them");
  static const Command kEnd{.name = "end", .help = "End it"};
  EXPECT_EQ(read_call(std::array{&kDraw, &kEnd}, Texts{"stop"}, "chimera").fault,
            "no command 'stop'; did you mean 'end'?; `chimera --help` lists them\n");
  EXPECT_EQ(fault({"stop"}), "no command 'stop'; `chimera --help` lists them") << "this table has no 'end'";
  EXPECT_EQ(read({"new"}).fault, "chimera new needs a command\n`chimera new --help` says more\n");
  EXPECT_EQ(fault({"new", "ap"}), "no command 'new ap'; did you mean 'new app'?; `chimera new --help` lists them");
  EXPECT_EQ(fault({"draw", "a", "--sise=3"}), "chimera draw has no option '--sise=3'; did you mean '--size'?");
  EXPECT_EQ(fault({"draw", "a", "--size"}), "--size needs a value: N");
  EXPECT_EQ(fault({"draw", "a", "--size="}), "--size needs a value: N");
  EXPECT_EQ(fault({"draw", "a", "--set", "x"}), "--set needs a value: VAR VALUE");
  EXPECT_EQ(fault({"draw", "a", "--size", "1", "--size", "2"}), "--size is given twice");
  EXPECT_EQ(fault({"draw", "a", "--fast=1"}), "--fast takes no value");
  EXPECT_EQ(fault({"draw", "a", "b"}), "'b' is one word too many");
  EXPECT_EQ(fault({"draw", "a", "--size", "1", "m"}),
            "'m' is one word too many: quote the value, --size '1 m', or write --size 1m");
  EXPECT_EQ(fault({"set", "kp=0.3"}), "set takes a name and a value, two words: chimera set kp '0.3'");
  EXPECT_EQ(fault({"set", "kp"}), "VAR VALUE is required");
  EXPECT_EQ(read({"pick"}).fault,
            "--by is required\nExample: chimera pick --by hand\n`chimera pick --help` says more\n");
}

TEST(ReadCall, RefusesValuesThatTheRowExcludes) {
  EXPECT_EQ(fault({"draw", "a", "--as", "png"}), "--as: png not in {dot,svg}");
  EXPECT_EQ(fault({"draw", "a", "--as", "dot svg"}), "--as: dot svg not in {dot,svg}");
  EXPECT_EQ(fault({"draw", "a", "--to", ""}), "--to: names no file");
  for (const char* wrong : {"0", "10", "-1", "1.5", "x", "2x", ""})
    EXPECT_EQ(fault({"draw", "a", "--size", wrong}),
              "--size: '" + std::string(wrong) + "' is not a whole number from 1 to 9");
  EXPECT_EQ(fault({"draw", "a", "--seed", "18446744073709551615"}), "");
  EXPECT_EQ(fault({"draw", "a", "--seed", "18446744073709551616"}),
            "--seed: '18446744073709551616' is not a whole number from 0 to 2^64-1");
  EXPECT_EQ(fault({"draw", "a", "--fast", "--seed", "1"}), "--fast excludes --seed");
  EXPECT_EQ(fault({"pick", "s", "--by", "x", "--on", "a"}), "SET excludes --on");
}

TEST(ReadCall, HelpWinsOverFaults) {
  EXPECT_TRUE(read({"--bogus", "--help"}).is_help);
  EXPECT_EQ(read({"--help"}).call.command, nullptr);
  const std::vector<Texts> calls = {
      {"draw", "--bogus", "-h"}, {"draw", "--size", "x", "--help"}, {"draw", "--help", "a", "b"}};
  for (const Texts& words : calls) {
    EXPECT_TRUE(read(words).is_help) << words[1];
    EXPECT_EQ(read(words).fault, "") << words[1];
    EXPECT_EQ(read(words).call.command, &kDraw);
  }
  EXPECT_EQ(call_of({"draw", "--", "--help"}).operands, Texts{"--help"});
}

TEST(HelpText, ShowsOperandsOptionsAndExamples) {
  EXPECT_EQ(help_text(kTable, &kDraw, "chimera"),
            "Draw it\nUsage: chimera draw [OPTIONS] FILE\n\n"
            "  FILE                        the drawing\n\n"
            "Options:\n"
            "  -h,--help                   Print this help and exit\n"
            "  --as FORMAT:{dot,svg}       \n"
            "  -f,--fast                   at once\n"
            "  --set VAR VALUE ...         \n"
            "  --names LIST ...            \n"
            "  --size N                    \n"
            "  --seed N (not with --fast)  \n"
            "  --to FILE                   \n"
            "  --json                      as JSON\n"
            "  --subsystem NAME            which one\n\n"
            "That is all.\n"
            "Examples: chimera draw a.yaml\n"
            "          chimera draw b.yaml --fast\n");
  EXPECT_NE(help_text(kTable, &kPick, "chimera").find("  --by HOW REQUIRED           \n"), std::string::npos);
}

TEST(HelpText, ShowsTheCommandsOfACommand) {
  EXPECT_EQ(help_text(kTable, &kNew, "chimera"),
            "Make one\nUsage: chimera new [OPTIONS] COMMAND\n\n"
            "Options:\n"
            "  -h,--help                   Print this help and exit\n\n"
            "Commands:\n"
            "  app NAME                    An app\n");
  EXPECT_EQ(help_text(kTable, nullptr, "chimera"),
            "  new                         Make one\n"
            "  draw FILE                   Draw it\n"
            "  pick [SET]                  Pick some\n"
            "  set VAR VALUE               Set it\n");
  static const Command kSpawn{.name = "spawn", .help = "Create", .is_rare = true};
  EXPECT_EQ(help_text(std::array{&kSpawn, &kNew}, nullptr, "chimera"),
            "  new                         Make one\n\nSeldom needed:\n"
            "  spawn                       Create\n");
}

}  // namespace
}  // namespace chimera::cli::command_test
