// SPDX-License-Identifier: Apache-2.0
#include "apps/chimera/shell_words.h"

#include <CLI/CLI.hpp>
#include <map>

#include "chimera/shell/carry_out.h"
#include "chimera/shell/command.h"
#include "chimera/shell/interactive.h"

using namespace chimera;  // NOLINT: a part of a main()

struct ShellWords {
  bool json = false;
  bool keeps_going = false;
  std::string subsystem, script;
  std::vector<std::string> operands;
  std::map<std::string, std::string> values;
  std::map<std::string, bool> flags;
};

namespace {

constexpr const char* kWhichOne = "which one: needed to act on one of another terminal and folder";

void add_command(CLI::App& app, const shell::Command& command, ShellWords& words) {
  CLI::App* c = app.add_subcommand(command.name, command.help);
  if (command.most > 0) {
    CLI::Option* operands = c->add_option(command.operands, words.operands, "see the example");
    operands->expected(static_cast<int>(command.least), static_cast<int>(command.most));
    if (command.least > 0) operands->required();
  }
  for (const shell::Option& option : command.options) {
    if (option.value == nullptr) c->add_flag(option.name, words.flags[option.name], option.help);
    else c->add_option(option.name, words.values[option.name], option.help)->type_name(option.value);
  }
  c->add_flag("--json", words.json, "the raw answer");
  c->add_option("--subsystem", words.subsystem, kWhichOne)->type_name("NAME");
  const std::string legend = command.legend;
  c->footer(legend + (legend.empty() ? "" : "\n") + "Example: " + command.example);
}

}  // namespace

std::shared_ptr<ShellWords> add_shell_commands(CLI::App& app) {
  auto words = std::make_shared<ShellWords>();
  for (const shell::Command& command : shell::commands())
    if (!command.is_shells) add_command(app, command, *words);
  CLI::App* s = app.add_subcommand("shell", "Type these commands one after the other, or take them from a file");
  s->add_option("FILE", words->script, "a script: one command a line, # begins a comment; - is standard input");
  s->add_flag("-k,--keep-going", words->keeps_going, "a script: go on after a refusal");
  s->add_option("--subsystem", words->subsystem, kWhichOne)->type_name("NAME");
  s->footer("Example: chimera shell --subsystem puma_pid");
  return words;
}

int carry_out_shell_command(const CLI::App& app, const ShellWords& words, const std::vector<std::string>& unit_files) {
  const shell::Surroundings surroundings{words.subsystem, unit_files};
  if (app.got_subcommand("shell")) return shell::interactive(surroundings, words.script, words.keeps_going);
  for (const shell::Command& command : shell::commands()) {
    if (command.is_shells || !app.got_subcommand(command.name)) continue;
    shell::Call call{&command, words.operands, {}, words.json};
    for (const shell::Option& option : command.options) {
      const auto value = words.values.find(option.name);
      if (option.value != nullptr && app.get_subcommand(command.name)->count(option.name) > 0)
        call.options[option.name] = value->second;
      const auto flag = words.flags.find(option.name);
      if (option.value == nullptr && flag->second) call.options[option.name] = "";
    }
    return shell::carry_out(surroundings, call, stdout, stderr);
  }
  return -1;
}
