// SPDX-License-Identifier: Apache-2.0
// Finds out which word of a command line is wrong, and puts that into a sentence with a remedy.
#include "apps/chimera/wrong_usage.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "chimera/cli/files/file_refusal.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/text/nearest.h"

using namespace chimera;  // NOLINT: a part of a main()

namespace {

/// The command that the words have reached.
const CLI::App& innermost(const CLI::App& app) {
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? app : innermost(*parsed.back());
}

/// "chimera new app".
std::string name_of(const CLI::App& app) {
  return app.get_parent() == nullptr ? "chimera" : name_of(*app.get_parent()) + " " + app.get_name();
}

std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// The line "Example: ..." of the help.
std::string example_of(const CLI::App& command) {
  const std::string footer = command.get_footer();
  const std::size_t at = footer.find("Example: ");
  return at == std::string::npos ? "" : footer.substr(at, footer.find('\n', at) - at) + "\n";
}

std::string about_option(const std::string& word, const CLI::App& command) {
  const std::string near = nearest(word.substr(0, word.find('=')), options_of(command));
  return name_of(command) + " has no option '" + word + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?") +
         "\n";
}

/// A word too many: behind the value of an option it is most often the unit that lost its quotes.
std::string about_word(const std::string& word, int argc, char** argv) {
  for (int i = 3; i < argc; ++i) {
    const std::string option = argv[i - 2], value = argv[i - 1];
    if (word != argv[i] || !option.starts_with("--") || value.find_first_not_of("+-.0123456789e") != std::string::npos)
      continue;
    return "'" + word + "' is one word too many: quote the value, " + option + " '" + value + " " + word +
           "', or write " + option + " " + value + word + "\n";
  }
  return "'" + word + "' is one word too many\n";
}

/// `set kp=0.3` where two words are wanted.
std::string about_operands(const CLI::ParseError& fault, const CLI::App& command, int argc, char** argv) {
  const std::string last = argc > 2 ? argv[argc - 1] : "";
  const std::size_t sign = last.find('=');
  if (command.get_name() == "set" && sign != std::string::npos && sign > 0)
    return "set takes a name and a value, two words: chimera set " + last.substr(0, sign) + " '" +
           last.substr(sign + 1) + "'\n";
  return std::string(fault.what()) + "\n";
}

/// Prints what is wrong with the words of a command, and where more is to be read.
int report(const std::string& what, const CLI::App& command) {
  const std::string text = what + example_of(command) + "`" + name_of(command) + " --help` says more\n";
  std::fputs(text.c_str(), stderr);
  return cli::kUsage;
}

}  // namespace

int report_wrong_usage(const CLI::App& app, const CLI::ParseError& fault, int argc, char** argv) {
  if (fault.get_exit_code() == 0) {  // --help and --version
    std::ostringstream text;
    const int code = app.exit(fault, text, text);
    std::fputs(text.str().c_str(), stdout);
    (void)flush_and_look(stdout);
    return code;
  }
  const CLI::App& command = innermost(app);
  const std::vector<std::string> extras = app.remaining(true);
  std::string text;
  if (dynamic_cast<const CLI::ExtrasError*>(&fault) != nullptr && !extras.empty()) {
    const std::string& word = extras.front();
    text = word.starts_with("-") ? about_option(word, command) : about_word(word, argc, argv);
  } else {
    text = about_operands(fault, command, argc, argv);
  }
  return report(text, command);
}

int report_no_option(const std::string& option, const CLI::App& command) {
  return report(about_option(option, command), command);
}
