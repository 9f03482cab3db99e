// SPDX-License-Identifier: Apache-2.0
// Replaces, character by character, everything in a UTF-8 text that a terminal would act on.
#include "chimera/base/hosted/terminal_text.h"

#include <cstdint>
#include <cstdio>

namespace chimera {
namespace {

struct Character {
  std::uint32_t point = 0;
  std::size_t bytes = 1;
  bool is_valid = true;
};

Character character_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t lead = byte(at);
  if (lead < 0x80) return {lead, 1, true};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || at + bytes > text.size()) return {lead, 1, false};
  std::uint32_t point = lead & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(at + i) & 0xC0u) != 0x80) return {lead, 1, false};
    point = point << 6 | (byte(at + i) & 0x3Fu);
  }
  return {point, bytes, true};
}

bool is_between(std::uint32_t point, std::uint32_t first, std::uint32_t last) {
  return point >= first && point <= last;
}

bool steers(const Character& c) {
  return !c.is_valid || c.point < 0x20 || is_between(c.point, 0x7F, 0x9F) || c.point == 0x61C ||
         is_between(c.point, 0x200B, 0x200F) || is_between(c.point, 0x2028, 0x202E) ||
         is_between(c.point, 0x2060, 0x2069) || c.point == 0xFEFF;
}

enum class Form { kLine, kText, kJson };

std::string made_plain(std::string_view text, Form form) {
  std::string plain;
  plain.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character_at(text, at);
    const bool is_layout = form != Form::kLine && (c.point == '\n' || c.point == '\t');
    if (is_layout || !steers(c)) {
      plain += text.substr(at, c.bytes);
    } else if (form == Form::kJson && c.is_valid) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", c.point);
      plain += escape;
    } else {
      plain += ' ';
    }
    at += c.bytes;
  }
  return plain;
}

}  // namespace

std::string plain_line(std::string_view text) { return made_plain(text, Form::kLine); }

std::string plain_json(std::string_view json) { return made_plain(json, Form::kJson); }

std::string for_terminal(std::string_view text) {
  return text.starts_with('{') ? plain_json(text) : made_plain(text, Form::kText);
}

}  // namespace chimera
