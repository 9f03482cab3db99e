// SPDX-License-Identifier: Apache-2.0
// Writes rows of commands as roff and as bash.
#include "chimera/cli/command/page.h"

#include <cctype>
#include <sstream>

namespace chimera::cli {
namespace {

using Visible = std::vector<const Command*>;

/// The letters of a text as roff takes them; `bold` between backticks.
std::string roff(std::string_view text) {
  std::string made = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  bool is_bold = false;
  for (const char c : text) {
    if (c == '`') {
      is_bold = !is_bold;
      made += is_bold ? "\\fB" : "\\fR";
    } else if (c == '-') {
      made += "\\-";
    } else if (c == '\\') {
      made += "\\e";
    } else {
      made += c;
    }
  }
  return made;
}

/// "a draw" as "A draw."
std::string sentence(std::string text) {
  if (text.empty()) return text;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text.ends_with('.') ? text : text + ".";
}

std::string option_of_manual(const Option& option) {
  const std::string name = roff(option.name);
  const std::string head = option.value == nullptr ? ".B " + name : ".BI " + name + " \" " + option.value + "\"";
  return ".TP\n" + head + "\n" + roff(option.manual == nullptr ? sentence(option.help) : option.manual) + "\n";
}

std::string section(const Command& row) {
  std::string text = std::string(".SS ") + row.name + "\n";
  text += roff(row.manual == nullptr ? sentence(row.help) : row.manual) + "\n";
  for (const Option& option : options_of(row)) text += option_of_manual(option);
  return text;
}

std::string italic(const std::string& text) { return "\\fI" + text + "\\fR"; }
std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }

std::string synopsis(const Command& row) {
  std::string text;
  if (*row.operands != '\0') text += " " + italic(row.operands);
  bool has_others = false;
  for (const Option& option : row.options) {
    if (option.is_required) text += " " + bold(option.name) + " " + italic(option.value);
    has_others = has_others || !option.is_required;
  }
  if (has_others) text += " [" + italic("OPTION") + "]...";
  if (row.json != nullptr) text += " [" + bold("--json") + "]";
  if (row.which != nullptr) text += " [" + bold("--subsystem") + " " + italic("NAME") + "]";
  return std::string(".br\n.B chimera ") + row.name + (text.empty() ? "" : "\n" + text.substr(1)) + "\n";
}

std::string synopses(const Visible& rows) {
  std::string text;
  for (const Command* row : rows)
    if (!row->has_commands) text += synopsis(*row);
  return text;
}

std::string sections(const Visible& rows) {
  std::string text;
  for (const Command* row : rows) text += section(*row);
  return text;
}

/// The names of the commands of `above`, each behind a blank.
std::string names_of(const Visible& rows, std::string_view above) {
  std::string names;
  for (const Command* row : commands_of(rows, above)) names += " " + std::string(last_word(row->name));
  return names;
}

std::string words(const Visible& rows) {
  std::string text = "    '') echo '--help --version --json --subsystem" + names_of(rows, "") + "' ;;\n";
  for (const Command* row : rows) {
    text += std::string("    '") + row->name + "') echo '";
    for (const Option& option : options_of(*row)) text += (text.ends_with('\'') ? "" : " ") + std::string(option.name);
    if (row->has_commands) text += names_of(rows, row->name);
    text += "' ;;\n";
  }
  return text;
}

/// The function of the script that completes a word, with its arguments.
std::string completer(WordKind kind, const char* listed) {
  switch (kind) {
    case WordKind::kOneOf:
      return std::string("words ") + listed;
    case WordKind::kFile:
      return "file";
    case WordKind::kDescription:
      return "description";
    case WordKind::kComponent:
      return "component";
    case WordKind::kTestable:
      return "testable";
    case WordKind::kGroup:
      return "group";
    case WordKind::kTask:
    case WordKind::kTaskOrConfiguration:
      return "task";
    case WordKind::kVariable:
    case WordKind::kSetting:
      return "variable";
    case WordKind::kText:
    case WordKind::kNumber:
    case WordKind::kCommand:
      break;
  }
  return "text";
}

std::string branch(const std::string& words, const std::string& takes) {
  return "    '" + words + "') echo '" + takes + "' ;;\n";
}

std::string takes(const Visible& rows) {
  std::string text = branch(" --subsystem", "text");  // before a command
  for (const Command* row : rows) {
    const std::string name = row->name;
    if (row->has_commands) text += branch(name, "command");
    if (row->most > 0) text += branch(name, completer(row->operand_kind, row->operand_words));
    for (const Option& option : options_of(*row))
      if (option.value != nullptr) text += branch(name + " " + option.name, completer(option.kind, option.words));
  }
  return text;
}

}  // namespace

Result<std::string> page(const std::string& text, Table table) {
  Visible rows;
  for (const Command* row : table)
    if (!row->is_hidden && !row->is_shells) rows.push_back(row);
  std::istringstream in(text);
  std::string made;
  for (std::string line; std::getline(in, line);) {
    if (line == "@synopsis@")
      made += synopses(rows);
    else if (line == "@commands@")
      made += sections(rows);
    else if (line == "@words@")
      made += words(rows);
    else if (line == "@takes@")
      made += takes(rows);
    else if (line.starts_with('@'))
      return Error{ErrorCode::kBadInput, {"no such part of a page"}, {line}};
    else
      made += line + "\n";
  }
  return made;
}

}  // namespace chimera::cli
