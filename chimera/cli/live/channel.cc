// SPDX-License-Identifier: Apache-2.0
// Parses the name of a channel and takes its numbers out of a value.
#include "chimera/cli/live/channel.h"

#include <cctype>
#include <charconv>
#include <limits>

#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

bool is_name_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

Error not_a_channel(std::string_view text) {
  return {ErrorCode::kBadInput,
          std::string_view("'" + std::string(text) +
                           "' is not the name of a variable; expected a name such as q, q[2] or pose.x"),
          {}};
}

/// Length of one step of a part ("[12]" or ".name") at the beginning of `text`; 0 when there is none.
std::size_t step_length(std::string_view text) {
  std::size_t i = 1;
  if (text[0] == '[') {
    while (i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0) ++i;
    return i > 1 && i <= 7 && i < text.size() && text[i] == ']' ? i + 1 : 0;
  }
  while (i < text.size() && is_name_letter(text[i])) ++i;
  return text[0] == '.' && i > 1 ? i : 0;
}

const Json* part_of(const Json& value, std::string_view part) {
  const Json* at = &value;
  while (at != nullptr && !part.empty()) {
    const std::size_t length = step_length(part);
    if (length == 0) return nullptr;
    const std::string_view step = part.substr(0, length);
    if (step[0] == '[') {
      std::size_t index = 0;
      std::from_chars(step.data() + 1, step.data() + length - 1, index);
      at = at->is_array() && index < at->size() ? &(*at)[index] : nullptr;
    } else {
      at = at->find(step.substr(1));
    }
    part.remove_prefix(length);
  }
  return at;
}

void collect(const Json& value, const std::string& part, std::vector<ChannelNumber>& numbers) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) collect(value[i], part + "[" + std::to_string(i) + "]", numbers);
  } else if (value.is_object()) {
    for (const auto& [name, field] : value.items()) collect(field, part + "." + name, numbers);
  } else if (value.is_bool()) {
    numbers.push_back({part, value.as_bool() ? 1.0 : 0.0});
  } else if (value.is_number()) {
    numbers.push_back({part, value.as_double()});
  } else if (value.is_null()) {
    numbers.push_back({part, std::numeric_limits<double>::quiet_NaN()});
  }
}

}  // namespace

Result<ChannelName> read_channel(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && is_name_letter(text[end])) ++end;
  if (end == 0) return not_a_channel(text);
  std::string_view rest = text.substr(end);
  while (!rest.empty()) {
    const std::size_t length = step_length(rest);
    if (length == 0) return not_a_channel(text);
    rest.remove_prefix(length);
  }
  return ChannelName{std::string(text.substr(0, end)), std::string(text.substr(end))};
}

std::vector<ChannelNumber> numbers_of(const Json& value, const std::string& part) {
  std::vector<ChannelNumber> numbers;
  if (const Json* at = part_of(value, part)) collect(*at, part, numbers);
  return numbers;
}

}  // namespace chimera::cli
