// SPDX-License-Identifier: Apache-2.0
// Reads typed fields of JSON objects with defaults.
#include "chimera/cli/live/fields.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "chimera/base/hosted/terminal_text.h"

namespace chimera::cli {
namespace {

using Json = nlohmann::json;

std::optional<std::int64_t> whole(const Json& value) {
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX) return std::nullopt;
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (!value.is_number_float() || !(std::fabs(value.get<double>()) < 9e18)) return std::nullopt;
  return static_cast<std::int64_t>(value.get<double>());
}

}  // namespace

const Json& field(const Json& object, std::string_view key) {
  static const Json kNull;
  if (!object.is_object()) return kNull;
  const auto found = object.find(key);
  return found == object.end() ? kNull : *found;
}

std::string text_of(const Json& object, std::string_view key) {
  const Json& value = field(object, key);
  return value.is_string() ? plain_line(value.get_ref<const std::string&>()) : "";
}

std::int64_t whole_of(const Json& object, std::string_view key) { return whole(field(object, key)).value_or(0); }

std::optional<std::int64_t> whole_or_none(const Json& object, std::string_view key) {
  return whole(field(object, key));
}

double number_of(const Json& object, std::string_view key) {
  const Json& value = field(object, key);
  return value.is_number() ? value.get<double>() : 0;
}

bool truth_of(const Json& object, std::string_view key) {
  const Json& value = field(object, key);
  return value.is_boolean() && value.get<bool>();
}

std::vector<std::string> texts_of(const Json& object, std::string_view key) {
  std::vector<std::string> texts;
  for (const Json& item : field(object, key))
    if (item.is_string()) texts.push_back(plain_line(item.get_ref<const std::string&>()));
  return texts;
}

}  // namespace chimera::cli
