// SPDX-License-Identifier: Apache-2.0
// One command is one row: its operands, options, help and manual text. The command line, the shell, the completion for
// bash and the manual page are made from rows (docs/howto/add-a-command.md).
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"

namespace chimera::cli {

/// The kind of a word of a command line, from which its completion follows.
enum class WordKind : unsigned char {
  kText,         ///< nothing completes it
  kOneOf,        ///< one of the words listed in the row
  kNumber,       ///< a whole number from `least` to `most`, both of the row
  kFile,         ///< the path of a file; an empty one is refused
  kDescription,  ///< the path of a description, NAME.yaml
  kComponent,    ///< the name of an installed component
  kTestable,     ///< a component, a shared object or a folder
  kGroup,        ///< a group of users of this machine
  kTask,         ///< of the running subsystem, as the next four
  kTaskOrConfiguration,
  kVariable,
  kSetting,  ///< an operator variable; the words behind it are its value
  kCommand,  ///< a command of the shell
};

inline constexpr std::size_t kAnyNumber = 10'000;

/// An option of a command. Plain value: string literals.
struct Option {
  enum class Repeats : unsigned char { kNo, kOneEach, kManyEach };

  const char* name;             ///< "--since"
  const char* value = nullptr;  ///< what it takes, for help: "N"; nullptr: a flag
  const char* help = "";
  const char* manual = nullptr;  ///< what the manual says where that is more than the help; `bold`
  WordKind kind = WordKind::kText;
  const char* words = nullptr;     ///< of kOneOf, a blank between each two
  long long least = 0, most = -1;  ///< of kNumber; most -1: no limit
  Repeats repeats = Repeats::kNo;  ///< kManyEach: takes every word up to the next option
  char separator = '\0';           ///< cuts one value into several
  bool is_required = false;
  bool is_act = false;             ///< makes the command an act (Command::is_act)
  const char* letter = nullptr;    ///< "-k", the short form
  const char* excludes = nullptr;  ///< another option, or the operands by their name
};

/// Plain value: string literals.
struct Command {
  const char* name;                 ///< "set"; "new component" is a command of the command "new"
  const char* help;                 ///< one line
  const char* operands = "";        ///< as usage shows them: "TASK..."
  std::size_t least = 0, most = 0;  ///< number of operands
  WordKind operand_kind = WordKind::kText;
  const char* operand_words = nullptr;  ///< of kOneOf, a blank between each two
  const char* operand_help = "see the example";
  std::vector<Option> options = {};
  const char* json = "the raw answer";  ///< help of --json; nullptr: the command has no --json
  const char* which = nullptr;          ///< help of --subsystem NAME; nullptr: the command has no --subsystem
  const char* footer = "";              ///< lines behind the options of the help
  const char* example = "";             ///< of several one a line
  const char* manual = nullptr;         ///< what the manual says in place of the help; `bold`
  bool is_act = false;        ///< changes a running subsystem, or names a process of it, which the user then signals
  bool is_shells = false;     ///< understood inside `chimera shell` only
  bool has_commands = false;  ///< is nothing without one of its own commands, such as `new`
  bool is_rare = false;       ///< not of the first month: the help of the program has it at its end
  bool is_hidden = false;     ///< not for people: in no help, manual or completion
  bool outlives_reader = false;  ///< goes on when its output has no reader; the others end by SIGPIPE, as `cat` does
};

/// A command as the user gave it.
struct Call {
  const Command* command = nullptr;
  std::vector<std::string> operands;
  /// The values by the name of the option, in the order given; of a flag none.
  std::map<std::string, std::vector<std::string>, std::less<>> options;
  bool json = false;

  bool has(std::string_view option) const { return options.find(option) != options.end(); }
  /// The last value of an option, or "".
  std::string value(std::string_view option) const;
  std::vector<std::string> values(std::string_view option) const;
  /// The operand of that index, or "".
  std::string operand(std::size_t index) const { return index < operands.size() ? operands[index] : ""; }
  /// Changes a running subsystem, by the command itself or by one of its options.
  bool is_act() const;
};

/// A table by reference. Context of all: setup.
using Table = std::span<const Command* const>;

/// nullptr when there is none of that name.
const Command* command_named(Table table, std::string_view name);

/// The commands of `above` that help shows, in order; of the program if `above` is "". The name of one ends with
/// last_word() of it.
std::vector<const Command*> commands_of(Table table, std::string_view above);
std::string_view last_word(std::string_view name);
/// --help, the options of the row, --json and --subsystem, as far as the command has them.
std::vector<Option> options_of(const Command& command);

/// A command line that was read.
struct CallReading {
  Call call;             ///< its command is null if the words name none
  bool is_help = false;  ///< the help of the command, or of the program without one
  std::string fault;     ///< lines that say what is wrong and what to type; "": nothing is wrong
};

/// Reads the words of a command line. `program` is "chimera"; or "" in the shell, where a command has no --subsystem
/// and no option stands before it.
CallReading read_call(Table table, std::span<const std::string> words, std::string_view program);

/// `call` as it is typed at a command line: "chimera set kp '[100 90] N.m/rad'".
std::string command_line(const Call& call);

/// The help of a command; of nullptr a line for each command. `program` as in read_call().
std::string help_text(Table table, const Command* command, std::string_view program);

}  // namespace chimera::cli
