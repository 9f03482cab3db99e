// SPDX-License-Identifier: Apache-2.0
// Walks a JSON tree with the path of each refusal.
#include "chimera/text/json_cursor.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

std::string shown(std::string_view text) { return in_double_quotes(text.substr(0, 60)); }

std::string kind(const Json& value) {
  if (value.is_whole()) return "a whole number";
  if (value.is_number()) return "a fraction";
  if (value.is_string()) return shown(value.as_string());
  if (value.is_bool()) return value.as_bool() ? "true" : "false";
  return value.is_null() ? "null" : value.is_array() ? "a list" : "an object";
}

std::size_t nesting_of(std::string_view text) {
  std::size_t depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

void JsonCursor::expect_keys(std::initializer_list<std::string_view> required,
                             std::initializer_list<std::string_view> optional) const {
  if (!value_.is_object()) refuse("expected an object, found " + kind(value_));
  std::vector<std::string> known(required.begin(), required.end());
  known.insert(known.end(), optional.begin(), optional.end());
  for (const auto& [key, unused] : value_.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    refuse("unknown key " + shown(key) + did_you_mean(nearest(key, known), '"'));
  }
  for (const std::string_view key : required) {
    if (!value_.contains(key)) refuse("the key " + shown(key) + " is missing");
  }
}

bool JsonCursor::has(std::string_view key) const { return value_.contains(key); }

JsonCursor JsonCursor::at(std::string_view key) const { return {value_.at(key), path_ + "." + std::string(key)}; }

JsonCursor JsonCursor::at(std::size_t i) const { return {value_[i], path_ + "[" + std::to_string(i) + "]"}; }

std::size_t JsonCursor::size(std::size_t limit) const {
  if (!value_.is_array()) refuse("expected a list, found " + kind(value_));
  if (value_.size() > limit) {
    refuse("a list of " + std::to_string(value_.size()) + ", at most " + std::to_string(limit) + " are allowed");
  }
  return value_.size();
}

std::string JsonCursor::text() const {
  if (!value_.is_string()) refuse("expected a text, found " + kind(value_));
  return value_.as_string();
}

bool JsonCursor::truth() const {
  if (!value_.is_bool()) refuse("expected true or false, found " + kind(value_));
  return value_.as_bool();
}

std::uint32_t JsonCursor::whole() const {
  if (!value_.is_whole() || value_.as_int64() < 0 || value_.as_int64() > UINT32_MAX) {
    refuse("expected a whole number from 0 to 4294967295, found " + kind(value_));
  }
  return static_cast<std::uint32_t>(value_.as_int64());
}

double JsonCursor::number() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (value_.is_string() && value_.as_string() == "inf") return kInfinity;
  if (value_.is_string() && value_.as_string() == "-inf") return -kInfinity;
  if (!value_.is_number()) refuse("expected a number, found " + kind(value_));
  return value_.as_double();
}

Json read_json(std::string_view text, std::size_t bytes, std::size_t nesting) {
  if (text.size() > bytes) {
    throw JsonRefusal{"$: " + std::to_string(text.size()) + " bytes, at most " + std::to_string(bytes) +
                      " are allowed"};
  }
  if (nesting_of(text) > nesting) throw JsonRefusal{"$: nested deeper than " + std::to_string(nesting)};
  std::optional<std::string> twice;
  try {
    Json tree = Json::parse(text, &twice);
    if (twice) throw JsonRefusal{"$: the key " + shown(*twice) + " comes twice in one object"};
    return tree;
  } catch (const JsonError& error) {
    throw JsonRefusal{"$: " + std::string(error.what()).substr(0, 200)};
  }
}

}  // namespace chimera
