// SPDX-License-Identifier: Apache-2.0
// Turns the rows of the table into subcommands of CLI11, and what was typed into a call.
#include "apps/chimera/command_line.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "apps/chimera/wrong_usage.h"
#include "chimera/cli/command/command_result.h"
#include "chimera/text/nearest.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Command;
using cli::Option;
using cli::WordKind;

/// One row as CLI11 reads it, and where it puts the words.
struct Subcommand {
  const Command* row = nullptr;
  CLI::App* app = nullptr;
  bool json = false;
  std::string operand;  ///< of a command that takes one at most
  std::vector<std::string> operands;
  std::map<std::string_view, bool> flags;
  std::map<std::string_view, std::string> texts;
  std::map<std::string_view, std::vector<std::string>> lists;
  std::map<std::string_view, std::vector<std::pair<std::string, std::string>>> pairs;
};

namespace {

std::string without_dots(const std::string& name) {
  return name.ends_with("...") ? name.substr(0, name.size() - 3) : name;
}

/// The names of the operands as CLI11 shows them, which marks by itself what may be left out or repeated.
std::string operand_name(const Command& row) {
  std::string name = row.operands;
  if (name.starts_with("[")) name = name.substr(1, name.size() - 2);
  return without_dots(name);
}

std::vector<std::string> words_in(const char* text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

CLI::Option* add_operands(Subcommand& sub) {
  const Command& row = *sub.row;
  if (row.most == 0) return nullptr;
  CLI::Option* added = nullptr;
  if (row.most == 1) {
    added = sub.app->add_option(operand_name(row), sub.operand, row.operand_help);
  } else {
    added = sub.app->add_option(operand_name(row), sub.operands, row.operand_help);
    const bool is_open = row.most == cli::kAnyNumber;
    added->expected(static_cast<int>(row.least),
                    is_open ? CLI::detail::expected_max_vector_size : static_cast<int>(row.most));
  }
  if (row.least > 0) added->required();
  return added;
}

/// Accepts the digits of a whole number from `least` to `most` and nothing else: no sign, no unit.
CLI::Validator whole_number(const Option& option) {
  const auto least = static_cast<std::uint64_t>(option.least);
  const std::uint64_t most = option.most < 0 ? UINT64_MAX : static_cast<std::uint64_t>(option.most);
  return CLI::Validator(
      [least, most](std::string& given) {
        std::uint64_t number = 0;
        const char* const end = given.data() + given.size();
        const auto [read_to, error] = std::from_chars(given.data(), end, number);
        if (error == std::errc() && read_to == end && number >= least && number <= most) return std::string();
        return "'" + given + "' is not a whole number from " + std::to_string(least) + " to " +
               (most == UINT64_MAX ? "2^64-1" : std::to_string(most));
      },
      "");
}

CLI::Option* add_value(Subcommand& sub, const Option& option) {
  CLI::App& app = *sub.app;
  if (std::string_view(option.value).find(' ') != std::string_view::npos)
    return app.add_option(option.name, sub.pairs[option.name], option.help);
  if (option.repeats != Option::Repeats::kNo) return app.add_option(option.name, sub.lists[option.name], option.help);
  return app.add_option(option.name, sub.texts[option.name], option.help);
}

CLI::Option* add_option(Subcommand& sub, const Option& option) {
  const std::string names = (option.letter == nullptr ? "" : std::string(option.letter) + ",") + option.name;
  if (option.value == nullptr) return sub.app->add_flag(names, sub.flags[option.name], option.help);
  CLI::Option* added = add_value(sub, option);
  added->type_name(option.value)->required(option.is_required);
  if (option.repeats == Option::Repeats::kOneEach) added->allow_extra_args(false);
  if (option.separator != '\0') added->delimiter(option.separator);
  if (option.kind == WordKind::kNumber) added->check(whole_number(option));
  if (option.kind == WordKind::kOneOf) added->check(CLI::IsMember(words_in(option.words)));
  if (option.kind == WordKind::kFile)  // "" is a wrong call, not "no file"
    added->check(
        CLI::Validator([](std::string& given) { return given.empty() ? "names no file" : std::string(); }, ""));
  return added;
}

std::string footer_of(const Command& row) {
  std::string text = row.footer, example = row.example;
  if (!text.empty() && !example.empty()) text += "\n";
  const bool is_one = example.find('\n') == std::string::npos;
  for (std::size_t at = 0; (at = example.find('\n', at)) != std::string::npos; ++at) example.insert(at + 1, 10, ' ');
  return example.empty() ? text : text + (is_one ? "Example: " : "Examples: ") + example;
}

void fill(Subcommand& sub) {
  const Command& row = *sub.row;
  if (row.has_commands) sub.app->require_subcommand(1);
  if (row.is_hidden) sub.app->group("");
  std::map<std::string, CLI::Option*> added = {{operand_name(row), add_operands(sub)}};
  for (const Option& option : row.options) added[option.name] = add_option(sub, option);
  for (const Option& option : row.options)
    if (option.excludes != nullptr) added.at(option.name)->excludes(added.at(option.excludes));
  if (row.json != nullptr) sub.app->add_flag("--json", sub.json, row.json);
  if (row.which != nullptr) sub.app->add_option("--subsystem", sub.texts["--subsystem"], row.which)->type_name("NAME");
  if (const std::string footer = footer_of(row); !footer.empty()) sub.app->footer(footer);
}

cli::Call call_of(const Subcommand& sub) {
  cli::Call call{sub.row, sub.operands, {}, sub.json};
  if (sub.row->most == 1 && sub.app->count(operand_name(*sub.row)) > 0) call.operands.push_back(sub.operand);
  for (const auto& [name, is_set] : sub.flags)
    if (is_set) call.options[std::string(name)] = {};
  for (const auto& [name, text] : sub.texts)
    if (sub.app->count(std::string(name)) > 0) call.options[std::string(name)] = {text};
  for (const auto& [name, list] : sub.lists)
    if (sub.app->count(std::string(name)) > 0) call.options[std::string(name)] = list;
  for (const auto& [name, list] : sub.pairs)
    for (const auto& [first, second] : list) {
      call.options[std::string(name)].push_back(first);
      call.options[std::string(name)].push_back(second);
    }
  return call;
}

/// Behind the options that stand before a command; "": none.
std::string first_word(int argc, char** argv) {
  int i = 1;
  for (; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--subsystem")
      ++i;
    else if (word != "--json" && !word.starts_with("--subsystem="))
      break;
  }
  return i < argc ? argv[i] : "";
}

}  // namespace

struct CommandLine::Parser {
  CLI::App app{"Real-time control software assembled from components: check it, run it, look at it."};
  std::deque<Subcommand> subcommands;
  // Given before the command.
  std::string subsystem;
  bool json = false;

  CLI::App* add(const Command& row) {
    const std::string name = row.name;
    const std::size_t blank = name.find(' ');
    if (blank == std::string::npos) return app.add_subcommand(name, row.help);
    return app.get_subcommand(name.substr(0, blank))->add_subcommand(name.substr(blank + 1), row.help);
  }

  void add_options() {
    app.add_flag("--json", json, "as behind a command that has it");
    app.add_option("--subsystem", subsystem, "as behind a command on a running subsystem")->type_name("NAME");
  }

  /// The call with what stood before the command; "": it takes all that. Else the option that it does not have.
  std::string complete(cli::Call& call) const {
    if (json && call.command->json == nullptr) return "--json";
    if (app.count("--subsystem") > 0 && call.command->which == nullptr) return "--subsystem";
    call.json = call.json || json;
    if (app.count("--subsystem") > 0 && !call.has("--subsystem")) call.options["--subsystem"] = {subsystem};
    return "";
  }
};

CommandLine::CommandLine(cli::Table table, const std::string& documents) : parser_(std::make_unique<Parser>()) {
  CLI::App& app = parser_->app;
  app.require_subcommand(1);
  app.footer("`chimera COMMAND --help` has an example. Documents and examples: " + documents);
  app.set_version_flag("--version", CHIMERA_VERSION);
  parser_->add_options();
  for (const Command* row : table) {
    Subcommand& sub = parser_->subcommands.emplace_back();
    sub.row = row;
    sub.app = parser_->add(*row);
    fill(sub);
  }
}

CommandLine::~CommandLine() = default;

std::optional<cli::Call> CommandLine::read(int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* one : parser_->app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(one->get_name());
  const std::string first = first_word(argc, argv);
  if (!first.empty() && first[0] != '-' && std::find(names.begin(), names.end(), first) == names.end()) {
    const std::string near = nearest(first, names);
    const std::string hint = near.empty() ? "" : "; did you mean '" + near + "'?";
    std::fprintf(stderr, "no command '%s'%s; `chimera --help` lists them\n", first.c_str(), hint.c_str());
    return exit_code_ = cli::kUsage, std::nullopt;
  }
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::ParseError& fault) {
    return exit_code_ = report_wrong_usage(parser_->app, fault, argc, argv), std::nullopt;
  }
  for (const Subcommand& sub : parser_->subcommands) {
    if (sub.row->has_commands || !sub.app->parsed()) continue;
    cli::Call call = call_of(sub);
    const std::string option = parser_->complete(call);
    if (option.empty()) return call;
    return exit_code_ = report_no_option(option, *sub.app), std::nullopt;
  }
  return std::nullopt;
}
