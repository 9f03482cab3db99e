// SPDX-License-Identifier: Apache-2.0
// Writes literals so that every compiler reads back the same values.
#include "chimera/bake/source_text.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace chimera::bake {

std::string literal(std::string_view text) {
  std::string all = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    char code[8];
    if (c == '"' || c == '\\') (all += '\\') += c;
    else if (byte >= 0x20 && byte < 0x7f) all += c;
    else std::snprintf(code, sizeof code, "\\%03o", static_cast<unsigned>(byte)), all += code;  // three digits end it
  }
  return all + "\"";
}

std::string literal(double value) {
  if (std::isnan(value)) return "__builtin_nan(\"\")";
  if (std::isinf(value)) return value > 0 ? "__builtin_inf()" : "-__builtin_inf()";
  char text[64];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  std::string all(text, error == std::errc{} ? end : text);
  return all.find_first_of(".e") == std::string::npos ? all + ".0" : all;
}

std::string literal(Nanoseconds time) { return time == kNever ? "kNever" : "{" + std::to_string(time.count) + "}"; }

std::string literal(bool value) { return value ? "true" : "false"; }

Initialiser& Initialiser::add_text(const char* member, const std::string& text) {
  if (text.empty()) return *this;
  if (!all_.empty()) all_ += ", ";
  all_ += "." + std::string(member) + " = " + text;
  return *this;
}

std::string Definitions::array(const std::string& type, const std::string& name, std::span<const std::string> items) {
  if (items.empty()) return {};
  text_ += "constexpr " + type + " " + name + "[] = {\n";
  for (const std::string& item : items) text_ += "    " + item + ",\n";
  text_ += "};\n";
  return name;
}

std::string Definitions::bytes(std::span<const std::byte> bytes) {
  if (bytes.empty()) return {};
  const auto [known, is_new] = known_bytes_.try_emplace({bytes.begin(), bytes.end()},
                                                        "kBytes" + std::to_string(known_bytes_.size()));
  if (!is_new) return known->second;
  constexpr std::size_t kRow = 16;
  text_ += "alignas(8) constexpr std::byte " + known->second + "[] = {";
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%02x_b,", std::to_integer<unsigned>(bytes[i]));
    text_ += i % kRow == 0 && bytes.size() > kRow ? "\n    " : i == 0 ? "" : " ";
    text_ += text;
  }
  text_ += "};\n";
  return known->second;
}

}  // namespace chimera::bake
