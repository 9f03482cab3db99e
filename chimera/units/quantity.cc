// SPDX-License-Identifier: Apache-2.0
// Parses numbers with a unit, durations and rates.
#include "chimera/units/quantity.h"

#include <cmath>
#include <limits>

#include "chimera/text/decimal.h"

namespace chimera {
namespace {

__extension__ using Wide = unsigned __int128;

/// kBadInput: the text has the wrong form. kRefused: the form is right, but the number is not accepted.
Error refused(std::string_view text, std::string_view why, ErrorCode code = ErrorCode::kBadInput) {
  const std::string whole = "\"" + std::string(text.substr(0, 100)) + "\" " + std::string(why);
  return {code, std::string_view(whole), {}};
}

/// The text behind the number, without the one optional space between.
std::string_view unit_part(std::string_view text, std::size_t number_length) {
  std::string_view rest = text.substr(number_length);
  if (rest.size() > 1 && rest.front() == ' ') rest.remove_prefix(1);
  return rest;
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

}  // namespace

Result<Quantity> parse_quantity(std::string_view text, const UnitSystem& units) {
  Quantity quantity;
  for (const std::string_view infinity : {"inf", "+inf", "-inf"}) {
    if (!text.starts_with(infinity) || (text.size() > infinity.size() && text[infinity.size()] != ' ')) continue;
    quantity.value =
        infinity[0] == '-' ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    quantity.unit_text = unit_part(text, infinity.size());
  }
  if (quantity.value == 0) {
    const auto number = read_decimal(text);
    if (!number) return refused(text, "is no quantity; expected a number and a unit, as in \"1.5 kg\"");
    quantity.value = number->nearest;
    quantity.unit_text = unit_part(text, number->length);
  }
  if (quantity.unit_text.empty()) {
    quantity.unit_text = "1";
    return quantity;
  }
  const auto unit = units.parse(quantity.unit_text);
  if (!unit) return refused(text, "is no quantity: " + std::string(unit.error().message.view()));
  quantity.unit = unit.value();
  return quantity;
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
  if (!number) return refused(text, "is no duration; expected a number and a unit, as in \"5 ms\"");
  const std::string_view unit = unit_part(text, number->length);
  const std::int64_t scale = scale_of(kDurations, unit);
  if (unit.empty()) return refused(text, "has no unit; expected ns, us, ms, s, min or h");
  if (scale == 0) return refused(text, "is no duration: expected ns, us, ms, s, min or h");
  if (number->value.negative && number->value.digits != 0) return refused(text, "is negative", ErrorCode::kRefused);
  if (number->nearest * static_cast<double>(scale) > 9.2e18)
    return refused(text, "is longer than 292 years", ErrorCode::kRefused);
  const auto whole = number->is_exact ? number->value.whole(scale) : std::nullopt;
  if (!whole) return refused(text, "is no whole number of nanoseconds", ErrorCode::kRefused);
  return Nanoseconds{*whole};
}

Result<Rate> parse_rate(std::string_view text) {
  const auto number = read_decimal(text);
  if (!number) return refused(text, "is no rate; expected a number and a unit, as in \"1 kHz\"");
  const std::string_view unit = unit_part(text, number->length);
  const std::int64_t millihertz = scale_of(kRates, unit);
  if (unit.empty()) return refused(text, "has no unit; expected Hz, kHz, MHz, mHz or 1/s");
  if (millihertz == 0) return refused(text, "is no rate: expected Hz, kHz, MHz, mHz or 1/s");
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
