// SPDX-License-Identifier: Apache-2.0
// Parses a trigger and detects when its comparison becomes true.
#include "chimera/cli/live/trigger.h"

#include <cmath>

#include "chimera/cli/files/blanks.h"

namespace chimera::cli {
namespace {

struct Sign {
  std::string_view text;
  Comparison comparison;
};
constexpr Sign kSigns[] = {{">=", Comparison::kAtLeast}, {"<=", Comparison::kAtMost}, {"==", Comparison::kEqual},
                           {"!=", Comparison::kUnequal}, {">", Comparison::kAbove},   {"<", Comparison::kBelow}};

Error bad_trigger(std::string_view text, std::string_view why) {
  return {ErrorCode::kBadInput, std::string_view("trigger '" + std::string(text) + "': " + std::string(why)), {}};
}

bool holds(Comparison comparison, double value, double level) {
  switch (comparison) {
    case Comparison::kAbove: return value > level;
    case Comparison::kAtLeast: return value >= level;
    case Comparison::kBelow: return value < level;
    case Comparison::kAtMost: return value <= level;
    case Comparison::kEqual: return value == level;
    case Comparison::kUnequal: return value != level;
  }
  return false;
}

}  // namespace

Result<Trigger> Trigger::read(std::string_view text, const UnitSystem& units) {
  const std::size_t at = text.find_first_of("<>=!");
  const Sign* sign = nullptr;
  for (const Sign& candidate : kSigns)
    if (sign == nullptr && at != std::string_view::npos && text.substr(at).starts_with(candidate.text))
      sign = &candidate;
  if (sign == nullptr) return bad_trigger(text, "expected VARIABLE, one of > >= < <= == !=, QUANTITY");
  Trigger trigger;
  trigger.text_ = trimmed(std::string(text));
  trigger.comparison_ = sign->comparison;
  std::string left = trimmed(std::string(text.substr(0, at)));
  if (left.size() > 2 && left.front() == '|' && left.back() == '|') {
    trigger.is_absolute_ = true;
    left = trimmed(left.substr(1, left.size() - 2));
  }
  auto channel = read_channel(left);
  if (!channel) return bad_trigger(text, channel.error().message.view());
  trigger.channel_ = std::move(*channel);
  const std::string right = trimmed(std::string(text.substr(at + sign->text.size())));
  if (right == "true" || right == "false") {
    trigger.quantity_.value = right == "true" ? 1 : 0;
    return trigger;
  }
  auto quantity = parse_quantity(right, units);
  if (!quantity) return bad_trigger(text, quantity.error().message.view());
  trigger.quantity_ = *quantity;
  return trigger;
}

Result<double> Trigger::settle(std::string_view unit, const UnitSystem& units) {
  const auto wanted = units.parse(unit);
  if (!wanted) return wanted.error();
  const auto level = value_in(quantity_, wanted.value(), unit);
  if (!level) return bad_trigger(text_, level.error().message.view());
  return level_ = level.value();
}

bool Trigger::fires(double value) noexcept {
  const bool holds_now = holds(comparison_, is_absolute_ ? std::fabs(value) : value, level_) && !std::isnan(value);
  const bool is_edge = holds_now && held_ == std::optional<bool>(false);
  held_ = holds_now;
  return is_edge;
}

}  // namespace chimera::cli
