// SPDX-License-Identifier: Apache-2.0
// Parses numbers with a unit, durations and rates.
#include "chimera/units/quantity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "chimera/text/decimal.h"
#include "chimera/units/unit_text.h"

namespace chimera {
namespace {

__extension__ using Wide = unsigned __int128;

/// kBadInput: the text has the wrong form. kRefused: the form is right, but the number is not accepted.
Error refused(std::string_view text, std::string_view why, ErrorCode code = ErrorCode::kBadInput) {
  const std::string whole = "\"" + std::string(text.substr(0, 100)) + "\" " + std::string(why);
  return {code, std::string_view(whole), {}};
}

/// The length of the space at the beginning of `text`; 0: none.
std::size_t space_length(std::string_view text) {
  for (const std::string_view space : kSpaces)
    if (text.starts_with(space)) return space.size();
  return 0;
}

/// The text behind the number, without the one optional space between.
std::string_view unit_part(std::string_view text, std::size_t number_length) {
  const std::string_view rest = text.substr(number_length);
  const std::size_t space = space_length(rest);
  return rest.size() > space ? rest.substr(space) : rest;
}

/// `text` with its number in the form that is read: the minus of the keyboard, no sign between digits, and `comma` for
/// each comma.
std::string with_plain_number(std::string_view text, std::string_view comma) {
  constexpr std::string_view kMinus = "\xe2\x88\x92";
  std::string out;
  std::size_t at = 0;
  if (text.starts_with(kMinus)) out = "-", at = kMinus.size();
  while (at < text.size()) {
    const std::size_t space = space_length(text.substr(at)), next = at + std::max<std::size_t>(space, 1);
    const bool is_gap = text[at] == ',' || text[at] == '_' || space > 0;
    const bool is_between = !out.empty() && is_digit(out.back()) && next < text.size() && is_digit(text[next]);
    if (is_gap && is_between) out += text[at] == ',' ? comma : "";
    else if (is_digit(text[at]) || text[at] == '.' || text[at] == '+' || text[at] == '-') out += text[at];
    else break;
    at = next;
  }
  return out.append(text.substr(at));
}

/// True if exactly three digits are behind the comma: "1,500" may be 1.5 or 1500.
bool has_comma_of_thousands(std::string_view text) {
  std::size_t digits = 0;
  for (std::size_t at = text.find(','); at < text.size() - 1 && is_digit(text[at + 1]); ++at) ++digits;
  return digits == 3;
}

/// The refusal of a text. If `read` accepts its number in another spelling, it says that one, else `why`.
template <class Read>
Error misspelt(std::string_view text, const std::string& noun, std::string_view why, Read read) {
  const std::string point = with_plain_number(text, "."), whole = with_plain_number(text, "");
  const bool is_point = point != text && read(point), is_whole = whole != text && read(whole);
  if (!is_point && !is_whole) return refused(text, "is no " + noun + std::string(why));
  std::string ways = "is no " + noun + "; write \"" + (is_point ? point : whole) + "\"";
  if (is_point && has_comma_of_thousands(text)) ways += " or \"" + whole + "\"";
  return refused(text, ways);
}

struct NamedScale {
  std::string_view name;
  std::int64_t scale;
};

constexpr NamedScale kDurations[] = {
    {"ns", 1},         {"us", 1'000},        {"\xc2\xb5s", 1'000},    {"\xce\xbcs", 1'000},
    {"ms", 1'000'000}, {"s", 1'000'000'000}, {"min", 60'000'000'000}, {"h", 3'600'000'000'000}};
constexpr NamedScale kRates[] = {{"mHz", 1}, {"Hz", 1'000}, {"1/s", 1'000}, {"kHz", 1'000'000}, {"MHz", 1'000'000'000}};

template <std::size_t N>
std::int64_t scale_of(const NamedScale (&scales)[N], std::string_view unit) {
  for (const NamedScale& s : scales) {
    if (s.name == unit) return s.scale;
  }
  return 0;
}

/// 10^12 / (digits * scale * 10^exponent) ns, rounded to the nearest; 0 if it is outside all bounds.
std::int64_t period_of(const Decimal& number, std::int64_t millihertz) {
  Wide above = 1'000'000'000'000u, below = static_cast<Wide>(number.digits) * static_cast<Wide>(millihertz);
  if (number.exponent < -30 || number.exponent > 30) return 0;
  for (int e = number.exponent; e < 0; ++e) {
    if (above > std::numeric_limits<Wide>::max() / 20) return 0;
    above *= 10;
  }
  for (int e = number.exponent; e > 0; --e) {
    if (below > std::numeric_limits<Wide>::max() / 20) return 0;
    below *= 10;
  }
  const Wide period = (2 * above + below) / (2 * below);
  return period > INT64_MAX ? 0 : static_cast<std::int64_t>(period);
}

/// parse_quantity() without advice. A refusal is the part of the message behind "is no quantity".
Result<Quantity> read_quantity(std::string_view text, const UnitSystem& units) {
  Quantity quantity;
  for (const std::string_view infinity : {"inf", "+inf", "-inf"}) {
    if (!text.starts_with(infinity)) continue;
    if (text.size() > infinity.size() && space_length(text.substr(infinity.size())) == 0) continue;
    quantity.value =
        infinity[0] == '-' ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    quantity.unit_text = unit_part(text, infinity.size());
  }
  if (quantity.value == 0) {
    const auto number = read_decimal(text);
    if (!number)
      return Error{ErrorCode::kBadInput, std::string_view("; expected a number and a unit, as in \"1.5 kg\""), {}};
    quantity.value = number->nearest;
    quantity.unit_text = unit_part(text, number->length);
  }
  if (quantity.unit_text.empty()) {
    quantity.unit_text = "1";
    return quantity;
  }
  const auto unit = units.parse(quantity.unit_text);
  if (!unit) return Error{ErrorCode::kBadInput, {": " + std::string(unit.error().message.view())}, {}};
  quantity.unit = unit.value();
  return quantity;
}

}  // namespace

Result<Quantity> parse_quantity(std::string_view text, const UnitSystem& units) {
  auto quantity = read_quantity(text, units);
  if (quantity) return quantity;
  return misspelt(text, "quantity", quantity.error().message.view(),
                  [&](std::string_view other) { return read_quantity(other, units).has_value(); });
}

Result<double> value_in(const Quantity& quantity, const Unit& wanted, std::string_view wanted_text) {
  if (const auto to_wanted = conversion(quantity.unit, wanted)) {
    const double value = (*to_wanted)(quantity.value);
    if (std::isfinite(value) || !std::isfinite(quantity.value)) return value;
    const std::string far = "is not finite in \"" + std::string(wanted_text) + "\"; write a finite number";
    return Error{ErrorCode::kRefused, std::string_view(far), {}};
  }
  std::string why = "expected a quantity in \"" + std::string(wanted_text) + "\", found ";
  why += quantity.unit_text == "1" ? "a number without unit" : "one in \"" + quantity.unit_text + "\"";
  return Error{ErrorCode::kBadInput, std::string_view(why), {}};
}

Result<Nanoseconds> parse_duration(std::string_view text) {
  const auto number = read_decimal(text);
  const auto wrong = [text](std::string_view why) {
    return misspelt(text, "duration", why, [](std::string_view other) { return parse_duration(other).has_value(); });
  };
  if (!number) return wrong("; expected a number and a unit, as in \"5 ms\"");
  const std::string_view unit = unit_part(text, number->length);
  const std::int64_t scale = scale_of(kDurations, unit);
  if (unit.empty()) return refused(text, "has no unit; expected ns, us, ms, s, min or h");
  if (scale == 0) return wrong(": expected ns, us, ms, s, min or h");
  if (number->value.negative && number->value.digits != 0) return refused(text, "is negative", ErrorCode::kRefused);
  if (number->nearest * static_cast<double>(scale) > 9.2e18)
    return refused(text, "is longer than 292 years", ErrorCode::kRefused);
  const auto whole = number->is_exact ? number->value.whole(scale) : std::nullopt;
  if (!whole) return refused(text, "is no whole number of nanoseconds", ErrorCode::kRefused);
  return Nanoseconds{*whole};
}

Result<Rate> parse_rate(std::string_view text) {
  const auto number = read_decimal(text);
  const auto wrong = [text](std::string_view why) {
    return misspelt(text, "rate", why, [](std::string_view other) { return parse_rate(other).has_value(); });
  };
  if (!number) return wrong("; expected a number and a unit, as in \"1 kHz\"");
  const std::string_view unit = unit_part(text, number->length);
  const std::int64_t millihertz = scale_of(kRates, unit);
  if (unit.empty()) return refused(text, "has no unit; expected Hz, kHz, MHz, mHz or 1/s");
  if (millihertz == 0) return wrong(": expected Hz, kHz, MHz, mHz or 1/s");
  if (number->value.digits == 0 || number->value.negative)
    return refused(text, "is not above zero", ErrorCode::kRefused);
  const Nanoseconds period{period_of(number->value, millihertz)};
  if (period < kShortestPeriod || period > kLongestPeriod) {
    return refused(text, "has a period outside 1 us to 1 h", ErrorCode::kRefused);
  }
  const double scale = static_cast<double>(millihertz) / 1000;  // 1/1000 rounds, the others are whole
  return Rate{millihertz == 1 ? number->nearest / 1000 : number->nearest * scale, period};
}

}  // namespace chimera
