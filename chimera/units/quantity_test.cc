// SPDX-License-Identifier: Apache-2.0
#include "chimera/units/quantity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "chimera/units/testing/unit_samples.h"

namespace chimera {
namespace {

template <class T>
std::string refusal(const Result<T>& result) {
  return result ? "accepted" : std::string(result.error().message.view());
}

Quantity quantity(std::string_view text) {
  auto parsed = parse_quantity(text, our_units());
  EXPECT_TRUE(parsed) << text << ": " << refusal(parsed);
  return parsed ? *std::move(parsed) : Quantity{};
}

double in(std::string_view text, std::string_view wanted) {
  const auto value = value_in(quantity(text), unit(wanted), wanted);
  EXPECT_TRUE(value) << refusal(value);
  return value ? value.value() : NAN;
}

TEST(Quantity, ReadsNumbersWithAndWithoutUnit) {
  EXPECT_EQ(quantity("1.5 kg").value, 1.5);
  EXPECT_EQ(quantity("1.5 kg").unit_text, "kg");
  EXPECT_EQ(quantity("-0.3").unit_text, "1");
  EXPECT_EQ(quantity("-0.3").value, -0.3);
  EXPECT_TRUE(same(quantity("100 N.m/rad").unit, unit("N.m/rad")));
  EXPECT_EQ(quantity("5ms").value, 5);
  EXPECT_EQ(quantity("50%").unit_text, "%");
  EXPECT_TRUE(std::isinf(quantity("-inf rad").value));
}

TEST(Quantity, ConvertsIntoTheWantedUnit) {
  EXPECT_EQ(in("40 us", "s"), 4e-05);
  EXPECT_EQ(in("1.5 km", "m"), 1500);
  EXPECT_EQ(in("180 deg", "rad"), M_PI);
  EXPECT_EQ(in("20 degC", "K"), 293.15);
  EXPECT_EQ(in("50 %", "1"), 0.5);
  EXPECT_EQ(in("3", "1"), 3);
}

TEST(Quantity, IsRefusedWhereItIsNotFiniteInTheWantedUnit) {
  EXPECT_EQ(refusal(value_in(quantity("1e308 km"), unit("m"), "m")), "is not finite in \"m\"; write a finite number");
  EXPECT_EQ(value_in(quantity("1e308 km"), unit("m"), "m").error().code, ErrorCode::kRefused);
  EXPECT_EQ(in("1e308 m", "m"), 1e308);
  EXPECT_TRUE(std::isinf(in("inf m", "km"))) << "said so; its user judges it";
  EXPECT_EQ(in("1e-320 mm", "km"), 0) << "too small for a double";
}

TEST(Quantity, RefusesAnotherKindOfUnitAndAMissingOne) {
  EXPECT_EQ(refusal(value_in(quantity("3 J"), unit("N.m"), "N.m")),
            "expected a quantity in \"N.m\", found one in \"J\"");
  EXPECT_EQ(refusal(value_in(quantity("3"), unit("kg"), "kg")),
            "expected a quantity in \"kg\", found a number without unit");
  EXPECT_EQ(refusal(value_in(quantity("3 rad"), unit("1"), "1")), "expected a quantity in \"1\", found one in \"rad\"");
}

TEST(Quantity, RefusesMalformedText) {
  EXPECT_EQ(refusal(parse_quantity("fast", our_units())),
            "\"fast\" is no quantity; expected a number and a unit, as in \"1.5 kg\"");
  EXPECT_EQ(refusal(parse_quantity("nan", our_units())),
            "\"nan\" is no quantity; expected a number and a unit, as in \"1.5 kg\"");
  EXPECT_EQ(refusal(parse_quantity("1.5 Kg", our_units())),
            "\"1.5 Kg\" is no quantity: \"Kg\" is no known unit; did you mean \"kg\"?");
  EXPECT_EQ(refusal(parse_quantity("1.5  kg", our_units())),
            "\"1.5  kg\" is no quantity: unit \" kg\": expected a unit, found \" kg\"");
  EXPECT_EQ(refusal(parse_quantity("1,5 kg", our_units())),
            "\"1,5 kg\" is no quantity; write \"1.5 kg\"");
  EXPECT_EQ(refusal(parse_quantity("1e400", our_units())),
            "\"1e400\" is no quantity; expected a number and a unit, as in \"1.5 kg\"");
}

TEST(Quantity, AcceptsTheSpacesAndSignsOfWordProcessors) {
  for (const std::string space : {" ", "\xc2\xa0", "\xe2\x80\x89", "\xe2\x80\xaf"}) {
    EXPECT_EQ(in("1.5" + space + "N.m", "N.m"), 1.5);
    EXPECT_EQ(in("2 N" + space + "m", "N.m"), 2);
    EXPECT_EQ(parse_duration("5" + space + "ms").value().count, 5'000'000);
  }
  EXPECT_EQ(in("2 N\u22c5m", "N.m"), 2);
  EXPECT_EQ(in("2 \u2126", "V/A"), 2);
  EXPECT_EQ(in("2 k\u03a9", "V/A"), 2000);
  EXPECT_EQ(in("2 s\u207b\u00b9", "1/s"), 2);
}

TEST(Quantity, SaysHowToWriteANumberOfAnotherSpelling) {
  constexpr struct { const char *text, *way; } kSpellings[] = {
      {"1,5 kg", "\"1.5 kg\""},
      {"1_000 kg", "\"1000 kg\""},
      {"1 000 kg", "\"1000 kg\""},
      {"1\u202f000,5 kg", "\"1000.5 kg\""},
      {"\u22121.5 kg", "\"-1.5 kg\""},
      {"1,234,567 kg", "\"1234567 kg\""},
      {"1,500 kg", "\"1.500 kg\" or \"1500 kg\""}};
  for (const auto& [text, way] : kSpellings)
    EXPECT_EQ(refusal(parse_quantity(text, our_units())), "\"" + std::string(text) + "\" is no quantity; write " + way);
  EXPECT_EQ(refusal(parse_duration("1,5 ms")), "\"1,5 ms\" is no duration; write \"1.5 ms\"");
  EXPECT_EQ(refusal(parse_rate("1_000 Hz")), "\"1_000 Hz\" is no rate; write \"1000 Hz\"");
}

TEST(Duration, IsExactInDecimal) {
  EXPECT_EQ(parse_duration("0.1 ms").value().count, 100'000);
  EXPECT_EQ(parse_duration("40 us").value().count, 40'000);
  EXPECT_EQ(parse_duration("5ms").value().count, 5'000'000);
  EXPECT_EQ(parse_duration("0.000000001 s").value().count, 1);
  EXPECT_EQ(parse_duration("1e-3 us").value().count, 1);
  EXPECT_EQ(parse_duration("1.5 min").value().count, 90'000'000'000);
  EXPECT_EQ(parse_duration("2 h").value().count, 7'200'000'000'000);
  EXPECT_EQ(parse_duration("0 s").value().count, 0);
  EXPECT_EQ(parse_duration("-0 s").value().count, 0);
  EXPECT_EQ(parse_duration("\xc2\xb5s").has_value(), false);
  EXPECT_EQ(parse_duration("7 \xc2\xb5s").value().count, 7'000);
}

TEST(Duration, RefusesWithAReason) {
  EXPECT_EQ(refusal(parse_duration("0.5 ns")), "\"0.5 ns\" is no whole number of nanoseconds");
  EXPECT_EQ(refusal(parse_duration("0.1234567891 s")), "\"0.1234567891 s\" is no whole number of nanoseconds");
  EXPECT_EQ(refusal(parse_duration("-1 ms")), "\"-1 ms\" is negative");
  EXPECT_EQ(refusal(parse_duration("1e10 s")), "\"1e10 s\" is longer than 292 years");
  EXPECT_EQ(refusal(parse_duration("5")), "\"5\" has no unit; expected ns, us, ms, s, min or h");
  EXPECT_EQ(refusal(parse_duration("5 Hz")), "\"5 Hz\" is no duration: expected ns, us, ms, s, min or h");
  EXPECT_EQ(refusal(parse_duration("soon")), "\"soon\" is no duration; expected a number and a unit, as in \"5 ms\"");
}

TEST(Rate, GivesThePeriodRoundedToTheNearestNanosecond) {
  EXPECT_EQ(parse_rate("1 kHz").value().period.count, 1'000'000);
  EXPECT_EQ(parse_rate("1 kHz").value().hz, 1000);
  EXPECT_EQ(parse_rate("3 Hz").value().period.count, 333'333'333);
  EXPECT_EQ(parse_rate("0.3 kHz").value().period.count, 3'333'333);
  EXPECT_EQ(parse_rate("0.7 Hz").value().period.count, 1'428'571'429);
  EXPECT_EQ(parse_rate("500 mHz").value().period.count, 2'000'000'000);
  EXPECT_EQ(parse_rate("500 mHz").value().hz, 0.5);
  EXPECT_EQ(parse_rate("1 MHz").value().period, kShortestPeriod);
  EXPECT_EQ(parse_rate("10 1/s").value().period.count, 100'000'000);
  EXPECT_EQ(parse_rate("1e2 Hz").value().period.count, 10'000'000);
}

TEST(Rate, RefusesWithAReason) {
  EXPECT_EQ(refusal(parse_rate("0 Hz")), "\"0 Hz\" is not above zero");
  EXPECT_EQ(refusal(parse_rate("-5 Hz")), "\"-5 Hz\" is not above zero");
  EXPECT_EQ(refusal(parse_rate("2 MHz")), "\"2 MHz\" has a period outside 1 us to 1 h");
  EXPECT_EQ(refusal(parse_rate("0.27 mHz")), "\"0.27 mHz\" has a period outside 1 us to 1 h");
  EXPECT_EQ(refusal(parse_rate("1e-300 Hz")), "\"1e-300 Hz\" has a period outside 1 us to 1 h");
  EXPECT_EQ(refusal(parse_rate("1e300 Hz")), "\"1e300 Hz\" has a period outside 1 us to 1 h");
  EXPECT_EQ(refusal(parse_rate("100")), "\"100\" has no unit; expected Hz, kHz, MHz, mHz or 1/s");
  EXPECT_EQ(refusal(parse_rate("6 rad/s")), "\"6 rad/s\" is no rate: expected Hz, kHz, MHz, mHz or 1/s");
  EXPECT_EQ(refusal(parse_rate("often")), "\"often\" is no rate; expected a number and a unit, as in \"1 kHz\"");
}

}  // namespace
}  // namespace chimera
