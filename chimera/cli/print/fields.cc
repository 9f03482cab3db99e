// SPDX-License-Identifier: Apache-2.0
// Reads typed fields of JSON objects with defaults.
#include "chimera/cli/print/fields.h"

#include <cmath>

#include "chimera/base/hosted/terminal_text.h"

namespace chimera::cli {
namespace {

std::optional<std::int64_t> whole(const Json& value) {
  if (value.is_whole() && value.as_uint64() > INT64_MAX) return std::nullopt;
  if (value.is_whole()) return value.as_int64();
  if (!value.is_number() || !(std::fabs(value.as_double()) < 9e18)) return std::nullopt;
  return value.as_int64();
}

}  // namespace

std::string text_of(const Json& object, std::string_view key) {
  const Json& value = object[key];
  return value.is_string() ? plain_line(value.as_string()) : "";
}

std::int64_t whole_of(const Json& object, std::string_view key) { return whole(object[key]).value_or(0); }

std::optional<std::int64_t> whole_or_none(const Json& object, std::string_view key) { return whole(object[key]); }

double number_of(const Json& object, std::string_view key) {
  const Json& value = object[key];
  return value.is_number() ? value.as_double() : 0;
}

std::vector<std::string> texts_of(const Json& object, std::string_view key) {
  std::vector<std::string> texts;
  for (const Json& item : object[key])
    if (item.is_string()) texts.push_back(plain_line(item.as_string()));
  return texts;
}

}  // namespace chimera::cli
