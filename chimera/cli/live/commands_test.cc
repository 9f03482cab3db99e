// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/commands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "chimera/base/hosted/wording.h"
#include "chimera/control/methods.h"

namespace chimera::cli {
namespace {

Call read_call(const std::vector<std::string>& words) { return cli::read_call(shell_words(), words, "").call; }
std::string help_text(std::string_view name = {}) {
  return cli::help_text(shell_words(), command_named(shell_words(), name), "");
}

/// The first line of what is wrong.
std::string refusal(const std::vector<std::string>& words) {
  const std::string fault = cli::read_call(shell_words(), words, "").fault;
  return fault.substr(0, fault.find('\n'));
}

TEST(Command, OperandsAndOptionsComeInAnyOrder) {
  const Call call = read_call({"scope", "--for", "1 s", "q", "--json", "tau", "--csv", "a.csv"});
  EXPECT_EQ(call.operands, (std::vector<std::string>{"q", "tau"}));
  EXPECT_EQ(call.value("--for"), "1 s");
  EXPECT_EQ(call.value("--svg"), "");
  EXPECT_TRUE(call.has("--csv"));
  EXPECT_TRUE(call.json);
}

TEST(Command, RefusesWithTheNearestName) {
  EXPECT_EQ(refusal({"statsu"}), "no command 'statsu'; did you mean 'status'?; `help` lists them");
  EXPECT_EQ(refusal({"events", "--sinc", "3"}), "events has no option '--sinc'; did you mean '--since'?");
  EXPECT_EQ(refusal({"events", "--since"}), "--since needs a value: TIME|N");
  EXPECT_EQ(refusal({"why"}), "VAR is required");
  EXPECT_EQ(refusal({"status", "x"}), "'x' is one word too many");
  EXPECT_EQ(refusal({"status", "--subsystem", "x"}), "status has no option '--subsystem'");
  EXPECT_EQ(refusal({"get"}), "");
  EXPECT_EQ(cli::read_call(shell_words(), std::vector<std::string>{"why"}, "").fault,
            "VAR is required\nExample: chimera why tau\n`why --help` says more\n");
}

TEST(Command, IsTypedAgainAsItWasGiven) {
  const Call call = read_call({"scope", "q[0]", "--for", "1 s", "--json", "--csv", "a.csv"});
  EXPECT_EQ(cli::command_line(call), "chimera scope 'q[0]' --csv a.csv --for '1 s' --json");
  EXPECT_EQ(cli::command_line(read_call({"set", "kp", "it's"})), "chimera set kp 'it'\\''s'");
}

TEST(Command, ACommandWithAnEffectIsAnAct) {
  EXPECT_TRUE(read_call({"off", "pid"}).is_act());
  EXPECT_TRUE(read_call({"end"}).is_act());
  EXPECT_TRUE(read_call({"save", "--write"}).is_act());
  EXPECT_TRUE(read_call({"status", "--pid", "servo"}).is_act()) << "its user signals the process";
  EXPECT_FALSE(read_call({"save"}).is_act());
  EXPECT_FALSE(read_call({"status"}).is_act());
  EXPECT_FALSE(read_call({"get", "q"}).is_act());
}

TEST(Command, TheTableIsInOrderAndComplete) {
  const Table table = shell_words();
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Command& command = *table[i];
    EXPECT_LT(i == 0 ? "" : std::string(table[i - 1]->name), command.name);
    const std::string begins = command.is_shells ? command.name : std::string("chimera ") + command.name;
    EXPECT_TRUE(std::string(command.example).starts_with(begins)) << command.example;
  }
}

TEST(Command, EveryRowDoesSomethingWithAMethodOfTheProtocol) {
  for (const RunningCommand& row : running_commands()) {
    SCOPED_TRACE(row.words.name);
    EXPECT_TRUE(row.once != nullptr || row.live != nullptr || row.show != nullptr);
    const control::MethodRule* method = control::find_method(row.method);
    ASSERT_NE(method, nullptr);
    const bool has_act = row.words.is_act || std::ranges::any_of(row.words.options, &Option::is_act);
    EXPECT_TRUE(has_act || method->role == control::Role::kObserve) << "asks first which subsystem it may change";
  }
}

TEST(Command, EveryMethodOfTheProtocolHasACommand) {
  std::set<std::string> asked = {"hello", "describe", "unsubscribe"};  // by several commands, beside their own
  asked.insert({"check", "schedule", "library"});                      // by editors: the command line has its own
  asked.insert({"plan", "cancel"});                                    // by `switch` with an option
  asked.insert("text");                                                // by the page
  for (const control::MethodRule& method : control::methods())
    if (control::is_of_bench(method.id)) asked.insert(method.name);    // by the page, of chimera-web
  for (const RunningCommand& row : running_commands()) asked.insert(row.method);
  for (const control::MethodRule& method : control::methods()) EXPECT_TRUE(asked.contains(method.name)) << method.name;
  EXPECT_EQ(asked.size(), control::methods().size());
}

TEST(Command, ControlMdNamesEveryMethodAndEveryAct) {
  std::ifstream file(std::string(std::getenv("CHIMERA_SOURCE")) + "/docs/formats/control.md");
  std::stringstream text;
  text << file.rdbuf();
  std::string acts;
  for (const RunningCommand& row : running_commands()) {
    EXPECT_NE(text.str().find(std::string("| `") + row.method + "` |"), std::string::npos) << row.method;
    if (row.words.is_act) append_joined(acts, " ", row.words.name);
    for (const Option& option : row.words.options) {
      const std::string act = std::string("`") + row.words.name + " " + option.name + "`";
      EXPECT_EQ(text.str().find(act) != std::string::npos, option.is_act) << act;
    }
  }
  EXPECT_NE(text.str().find("Which words act: `" + acts + "`"), std::string::npos) << acts;
}

TEST(Command, HelpPrintsUsageOptionsAndAnExample) {
  EXPECT_EQ(help_text("events"),
            "Print the events of the subsystem, numbered without a gap\n"
            "Usage: events [OPTIONS]\n\n"
            "Options:\n"
            "  -h,--help                   Print this help and exit\n"
            "  --since TIME|N              events from a time on ('10 min' ago, '14:05', '2026-11-28'), or from N on\n"
            "  --kind KIND,...             only these, such as 'set,fault'\n"
            "  --each                      a line for every event; else misses within 100 ms of each other are one\n"
            "  --follow                    print new events as they happen, until Ctrl-C\n"
            "  --json                      the raw answer\n\n"
            "Example: chimera events --follow\n");
  EXPECT_NE(help_text("top").find("INPUT: age of the\noldest input\nExample: chimera top\n"), std::string::npos);
  EXPECT_NE(help_text().find("\n  why VAR                     Tell where a value comes from, "), std::string::npos);
}

}  // namespace
}  // namespace chimera::cli
