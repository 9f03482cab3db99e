// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/number_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

namespace chimera::number_text_test {
namespace {

constexpr unsigned kSeed = 20261128;

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// "" if read_number() and std::from_chars() agree on value, length and range.
std::string difference(const std::string& text) {
  double expected = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), expected);
  const ReadNumber read = read_number(text);
  const std::size_t length = code == std::errc::invalid_argument ? 0 : static_cast<std::size_t>(end - text.data());
  if (read.length != length) return "'" + text + "': length " + std::to_string(read.length);
  if (length == 0) return "";
  if (read.in_range != (code == std::errc())) return "'" + text + "': range";
  if (!read.in_range || bits(read.value) == bits(expected)) return "";
  return "'" + text + "': " + std::to_string(read.value) + ", expected " + std::to_string(expected);
}

class NumberText : public ::testing::Test {
 protected:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  /// A finite double of any size.
  double any_double() {
    for (;;)
      if (const double value = std::bit_cast<double>(random_()); std::isfinite(value)) return value;
  }
  std::string digits(std::size_t most) {
    std::string text;
    for (std::size_t n = below(most + 1); n > 0; --n) text += static_cast<char>('0' + below(10));
    return text;
  }

  std::mt19937_64 random_{kSeed};
};

TEST_F(NumberText, ReadsWhatFromCharsReads) {
  for (const char* text : {"0", "-0", "0.0", "1", "-1", "5.", ".5", "-.5e3", "1e5", "1E+5", "1e-5", "1e", "1e+", "1ex",
                           "12.5.5", "1.5:2", "007", "1e0000000000000000000005", "9007199254740993", "0.1", "0e99999",
                           "1e308", "1.7976931348623157e308", "1.7976931348623159e308", "1e309", "1e99999999999999999",
                           "4.9e-324", "2.4703282292062327e-324", "2.4703282292062328e-324", "2e-324", "1e-400",
                           "2.2250738585072011e-308", "2.2250738585072014e-308", "100000000000000000000000000000000"})
    EXPECT_EQ(difference(text), "");
  for (const char* text : {"", "-", ".", "-.", "e5", "+1", " 1", "x", "-e5", ".e1"})
    EXPECT_EQ(read_number(text).length, 0u) << text;
  EXPECT_EQ(read_number("inf").length, 0u);
  EXPECT_EQ(read_number("nan").length, 0u);
}

TEST_F(NumberText, RandomTextsReadAsFromCharsReadsThem) {
  for (int i = 0; i < 100'000; ++i) {
    std::string text = (below(2) ? "-" : "") + digits(below(4) == 0 ? 40 : 17);
    if (below(2)) text += "." + digits(below(4) == 0 ? 40 : 17);
    if (below(2)) text += (below(2) ? "e" : "E") + std::string(below(3) == 0 ? "-" : "") + std::to_string(below(330));
    ASSERT_EQ(difference(text), "") << "seed " << kSeed;
  }
}

TEST_F(NumberText, RandomBytesReadAsFromCharsReadsThem) {
  constexpr std::string_view kBytes = "0123456789.eE+-: x";
  for (int i = 0; i < 100'000; ++i) {
    std::string text;
    for (std::size_t n = below(12); n > 0; --n) text += kBytes[below(kBytes.size())];
    ASSERT_EQ(difference(text), "") << "seed " << kSeed;
  }
}

/// The middle between two neighbours needs up to 767 digits; one more digit decides.
TEST_F(NumberText, MiddlesBetweenTwoDoublesRoundToEven) {
  for (int i = 0; i < 2'000; ++i) {
    const double low = std::abs(any_double()), high = std::nextafter(low, std::numeric_limits<double>::infinity());
    if (!std::isfinite(high)) continue;
    char text[1600];
    const int size = std::snprintf(text, sizeof text, "%.1200Lf", (static_cast<long double>(low) + high) / 2);
    ASSERT_LT(size, static_cast<int>(sizeof text));
    ASSERT_EQ(difference(text), "");
    ASSERT_EQ(difference(text + std::string("1")), "");
    ASSERT_EQ(difference(text + std::string("00000000000000000000001e2")), "");
  }
}

TEST_F(NumberText, WritesWhatPrintfWrites) {
  const auto expect = [](double value, int digits) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    ASSERT_EQ(number_text(value, digits).view(), text) << digits << " digits, seed " << kSeed;
  };
  const double infinity = std::numeric_limits<double>::infinity();
  for (int digits = 1; digits <= 17; ++digits)
    for (double value : {0.0, -0.0, 1.0, -1.0, 0.5, 1.5, 2.5, 0.1, 9.5, 99.5, 999999.5, 0.00001, 0.0001, 123456789.0,
                         1e22, 1e23, 4.9e-324, 2.2250738585072014e-308, 1.7976931348623157e308, infinity, -infinity})
      expect(value, digits);
  for (int i = 0; i < 50'000; ++i) {
    const auto digits = static_cast<int>(1 + below(17));
    expect(any_double(), digits);
    expect(static_cast<double>(below(2'000'000)) / 1000 - 1000, digits);
    expect(static_cast<double>(below(4096)) / 64, digits);  // many ties
  }
  EXPECT_EQ(number_text(1234567.0).view(), "1.23457e+06");
  EXPECT_EQ(number_text(std::nan("")).view(), "nan");
  EXPECT_EQ(number_text(-std::nan("")).view(), "nan");
}

TEST_F(NumberText, SeventeenDigitsReadBackAsTheSameNumber) {
  for (int i = 0; i < 50'000; ++i) {
    const double value = any_double();
    const FixedString<24> text = number_text(value, 17);
    ASSERT_EQ(bits(read_number(text.view()).value), bits(value)) << text.view();
  }
}

}  // namespace
}  // namespace chimera::number_text_test
