// SPDX-License-Identifier: Apache-2.0
// Splits the text of a condition into a variable, an element, a comparison and a value.
#include "chimera/description/condition_text.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "chimera/description/draft_values.h"

namespace chimera {
namespace {

constexpr const char* kForm = "a comparison, as 'speed < 0.1 rad/s'";

// The longer signs come first, because "<=" begins with "<".
constexpr Relation kOrder[] = {Relation::kAtMost,  Relation::kAtLeast, Relation::kEqual,
                                 Relation::kUnequal, Relation::kLess,    Relation::kMore};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

// "q[2]": removes "[2]". False if the brackets hold no number.
bool take_element(std::string_view& name, std::optional<std::uint32_t>& element) {
  if (!name.ends_with(']')) return true;
  const std::size_t open = name.find('[');
  if (open == std::string_view::npos) return false;
  const std::string_view digits = trimmed(name.substr(open + 1, name.size() - open - 2));
  std::uint32_t number = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || fault != std::errc{} || end != digits.data() + digits.size()) return false;
  element = number;
  name = trimmed(name.substr(0, open));
  return true;
}

}  // namespace

std::optional<DraftCondition> read_condition(const Node& node, const std::string& what, Report& report) {
  const auto refuse = [&](const std::string& said) {
    report.add({.rule = "condition-bad",
                .at = node.at,
                .message = what + ' ' + said,
                .found = node.text,
                .expected = kForm,
                .remedy = "write VARIABLE, one of < <= > >= == !=, and a value: 'speed < 0.1 rad/s', 'q[2] > 0'"});
    return std::nullopt;
  };
  if (!node.is_scalar()) return refuse("is " + written(node) + "; expected " + kForm);
  const std::string_view text = node.text;
  const std::size_t at = text.find_first_of("<>=!");
  const auto begins = [&](Relation one) {
    return at != std::string_view::npos && text.substr(at).starts_with(sign_of(one));
  };
  const auto* const sign = std::find_if(std::begin(kOrder), std::end(kOrder), begins);
  if (sign == std::end(kOrder)) return refuse("is " + written(node) + ", which compares nothing");
  DraftCondition condition;
  condition.comparison = *sign;
  std::string_view name = trimmed(text.substr(0, at));
  if (!take_element(name, condition.element)) return refuse("is " + written(node) + ": no number in brackets");
  condition.variable = {std::string(name), node.at};
  if (!check_name(condition.variable, "the variable of " + what, report)) return std::nullopt;
  const std::string_view value = trimmed(text.substr(at + std::string_view(sign_of(*sign)).size()));
  if (value.empty()) return refuse("is " + written(node) + ": there is no value");
  condition.value.kind = Node::Kind::kScalar;
  condition.value.at = node.at;
  condition.value.text = value;
  return condition;
}

}  // namespace chimera
