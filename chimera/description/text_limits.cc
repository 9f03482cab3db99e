// SPDX-License-Identifier: Apache-2.0
// Checks size, encoding, tabs, nesting and number of entries of a text before it is parsed.
#include "chimera/description/text_limits.h"

#include <cstdio>
#include <string>

#include "chimera/description/yaml_reader.h"

namespace chimera {
namespace {

/// Length of the valid UTF-8 sequence at `at`, or 0: no overlong forms, no surrogates, nothing above U+10FFFF.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const unsigned char next = byte(1);
  const bool overlong = (lead == 0xE0 && next < 0xA0) || (lead == 0xF0 && next < 0x90);
  const bool beyond = (lead == 0xED && next > 0x9F) || (lead == 0xF4 && next > 0x8F);
  return overlong || beyond ? 0 : length;
}

bool is_control(unsigned char byte) {
  return (byte < 0x20 && byte != '\n' && byte != '\r' && byte != '\t') || byte == 0x7F;
}

void add_bad_byte(unsigned char byte, bool is_binary, Place at, Report& report) {
  char found[8];
  std::snprintf(found, sizeof found, "0x%02X", static_cast<unsigned>(byte));
  const bool control = is_control(byte);
  report.add({.rule = "text-encoding",
              .at = at,
              .message = std::string("byte ") + found + (control ? " is a control character" : " is not valid UTF-8"),
              .found = found,
              .expected = "text in UTF-8",
              .remedy = is_binary ? "this is a binary file; a description is YAML text"
                                  : "save the file as plain UTF-8 text"});
}

/// True if a tab indents the line before any text other than a comment.
bool has_tab_indent(std::string_view line, std::size_t& column) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos || line[first] == '#') return false;
  column = line.substr(0, first).find('\t');
  return column != std::string_view::npos;
}

bool has_zero(std::string_view text) { return text.find('\0') != std::string_view::npos; }

bool check_bytes(std::string_view text, Report& report) {
  Place at{1, 1};
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = is_control(byte) ? 0 : utf8_length(text, i);
    if (length == 0) {
      add_bad_byte(byte, has_zero(text), at, report);
      return false;
    }
    i += length;
    at.column += static_cast<std::uint32_t>(length);
    if (byte == '\n') at = {at.line + 1, 1};
  }
  return true;
}

bool check_tabs(std::string_view text, Report& report) {
  bool fine = true;
  std::uint32_t line_number = 1;
  for (std::size_t start = 0; start < text.size(); ++line_number) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::size_t column = 0;
    if (has_tab_indent(text.substr(start, end - start), column)) {
      fine = false;
      report.add({.rule = "text-tab",
                  .at = {line_number, static_cast<std::uint32_t>(column + 1)},
                  .message = "a tab in the indentation; YAML indents with spaces",
                  .found = "tab",
                  .expected = "spaces",
                  .remedy = "replace the tab by spaces"});
    }
    start = end + 1;
  }
  return fine;
}

std::size_t count_entries(std::string_view text) {
  std::size_t entries = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ',' || c == ':' || c == '[' || c == '{' || c == '\n') ++entries;
    const bool spaced = i + 1 == text.size() || text[i + 1] == ' ' || text[i + 1] == '\n';
    if ((c == '-' || c == '?') && spaced) ++entries;
  }
  return entries;
}

}  // namespace

bool check_text_limits(std::string_view text, Report& report) {
  if (text.size() > kMaxTextBytes && has_zero(text)) return check_bytes(text, report);  // not a text at all
  if (text.size() > kMaxTextBytes) {
    report.add({.rule = "text-size",
                .message = "the file has more than " + std::to_string(kMaxTextBytes) + " bytes",
                .found = std::to_string(text.size()),
                .expected = std::to_string(kMaxTextBytes),
                .remedy = "split the application into subsystems"});
    return false;
  }
  if (!check_bytes(text, report)) return false;
  const bool tabs = check_tabs(text, report);
  if (const std::size_t entries = count_entries(text); entries > kMaxEntries) {
    report.add({.rule = "text-entries",
                .message = "the file has " + std::to_string(entries) + " entries; at most " +
                           std::to_string(kMaxEntries) + " are read",
                .found = std::to_string(entries),
                .expected = std::to_string(kMaxEntries),
                .remedy = "split the application into subsystems"});
    return false;
  }
  return tabs;
}

}  // namespace chimera
