// SPDX-License-Identifier: Apache-2.0
// Parses lists and ranges of values with their unit.
#include "chimera/cli/batch/value_list.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/text/decimal.h"

namespace chimera::cli {
namespace {

/// A value as written, cut in two.
struct Item {
  std::string value, unit;
  bool is_text = false;  ///< neither a number nor a list: it has no unit
};

Error wrong_list(const std::string& text, const std::string& why) {
  return {ErrorCode::kBadInput, {"--over '" + text + "': " + why}, {}};
}

/// At the commas that stand outside of brackets and quotes.
std::vector<std::string> items_of(const std::string& text) {
  std::vector<std::string> items(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote == 0 && (c == '"' || c == '\''))
      quote = c;
    else if (quote == c)
      quote = 0;
    if (quote == 0 && (c == '[' || c == '{')) ++depth;
    if (quote == 0 && (c == ']' || c == '}')) --depth;
    if (c == ',' && depth == 0 && quote == 0)
      items.emplace_back();
    else
      items.back() += c;
  }
  for (std::string& item : items) item = trimmed(item);
  return items;
}

Item cut(const std::string& text) {
  if (text[0] == '[') {
    const std::size_t end = text.rfind(']');
    if (end != std::string::npos) return {text.substr(0, end + 1), trimmed(text.substr(end + 1)), false};
  }
  if (const auto number = read_decimal(text))
    return {text.substr(0, number->length), trimmed(text.substr(number->length)), false};
  return {text, {}, true};
}

bool is_range(const Item& item) { return item.value[0] == '[' && item.value.find(':') != std::string::npos; }

std::optional<double> number_of(const std::string& text) {
  const std::string plain = trimmed(text);
  const auto number = read_decimal(plain);
  return number && number->length == plain.size() ? std::optional(number->nearest) : std::nullopt;
}

/// The values of "[0.1:0.1:1.0]", as a person would write them.
Result<void> spread(const std::string& text, const Item& item, std::vector<Item>& to) {
  const std::string inside = item.value.substr(1, item.value.size() - 2);
  const std::size_t first = inside.find(':'), last = inside.rfind(':');
  const auto from = number_of(inside.substr(0, first)), end = number_of(inside.substr(last + 1));
  const auto step = first == last ? std::nullopt : number_of(inside.substr(first + 1, last - first - 1));
  if (!from || !step || !end)
    return wrong_list(text, "write a range as '[FIRST:STEP:LAST] UNIT', such as '[0.1:0.1:1] V'");
  const double steps = (*end - *from) / *step;
  if (*step == 0 || steps < 0)
    return wrong_list(text, "the range " + item.value + " does not come from its first to its last value");
  if (steps >= static_cast<double>(kMostRuns))
    return wrong_list(text, "the range " + item.value + " has more than " + std::to_string(kMostRuns) + " values");
  for (double i = 0; i <= std::floor(steps + 1e-9); ++i) {
    const double exact = *from + i * *step;
    to.push_back({formatted("%.12g", std::fabs(exact) < 1e-12 * std::fabs(*step) ? 0.0 : exact), item.unit, false});
  }
  return {};
}

/// The elements of "[1 2]" or "[1, 2]", each with the unit behind the list.
void add_elements(const Item& list, std::vector<Item>& to) {
  for (std::size_t at = 1, next = 0; at < list.value.size() - 1; at = next + 1) {
    next = std::min(list.value.find_first_of(" ,", at), list.value.size() - 1);
    if (next > at) to.push_back({list.value.substr(at, next - at), list.unit, false});
  }
}

ValueList listed(const std::string& name, std::vector<Item> items) {
  ValueList list{name, items.back().unit, {}, {}, {}};
  bool is_common = true;
  for (Item& item : items) {
    if (item.unit.empty() && !item.is_text) item.unit = items.back().unit;
    is_common = is_common && item.unit == items.back().unit && !item.is_text;
  }
  if (!is_common) list.unit.clear();
  for (const Item& item : items) {
    list.values.push_back(item.unit.empty() ? item.value : item.value + " " + item.unit);
    list.shown.push_back(is_common ? item.value : list.values.back());
    const auto number = is_common ? number_of(item.value) : std::nullopt;
    if (number) list.numbers.push_back(*number);
  }
  if (list.numbers.size() != list.values.size()) list.numbers.clear();
  return list;
}

}  // namespace

Result<ValueList> parse_value_list(const std::string& text,
                                   const std::function<bool(const std::string& name)>& is_single) {
  const std::size_t equals = text.find('=');
  const std::string name = trimmed(text.substr(0, equals));
  if (equals == std::string::npos || name.empty() || name.find(' ') != std::string::npos)
    return wrong_list(text, "write 'NAME = VALUE, VALUE UNIT' or 'NAME = [FIRST:STEP:LAST] UNIT'");
  std::vector<Item> items;
  for (const std::string& word : items_of(text.substr(equals + 1))) {
    if (word.empty()) return wrong_list(text, "a value is missing");
    const Item item = cut(word);
    if (!is_range(item) && word.find(':') != std::string::npos && is_digit(word[0]))
      return wrong_list(text, "write a range as '[FIRST:STEP:LAST] UNIT', such as '[0.1:0.1:1] V'");
    if (!is_range(item) && item.value[0] == '[' && is_single && is_single(name))
      add_elements(item, items);
    else if (!is_range(item))
      items.push_back(item);
    else if (auto done = spread(text, item, items); !done)
      return done.error();
  }
  if (items.empty()) return wrong_list(text, "a value is missing");
  if (items.size() > kMostRuns) return wrong_list(text, "more than " + std::to_string(kMostRuns) + " values");
  return listed(name, std::move(items));
}

}  // namespace chimera::cli
