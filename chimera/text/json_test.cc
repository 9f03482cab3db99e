// SPDX-License-Identifier: Apache-2.0
#include "chimera/text/json.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

namespace chimera {
namespace {

std::string again(const char* text) { return Json::parse(text).dump(); }

std::string refusal(std::string_view text) {
  try {
    (void)Json::parse(text);
  } catch (const JsonError& error) {
    return error.what();
  }
  return "";
}

template <class Read>
std::string refusal_of(const Read& read) {
  try {
    read();
  } catch (const JsonError& error) {
    return error.what();
  }
  return "";
}

TEST(Json, WritesParsedJsonWithSortedKeysOnOneLine) {
  EXPECT_EQ(again(R"( {"b" : [1, -2, 2.5, "x", true, false, null, {}],
                       "a": {"z": []}} )"),
            R"({"a":{"z":[]},"b":[1,-2,2.5,"x",true,false,null,{}]})");
  EXPECT_EQ(again("null"), "null");
  EXPECT_EQ(again("\"\""), "\"\"");
}

TEST(Json, WritesKeysAsMadeAndIndentsOnRequest) {
  Json json = {{"b", 1}, {"a", {{"z", Json::array()}, {"y", {1, "x"}}}}};
  json["0"] = Json::object();
  EXPECT_EQ(json.dump(), R"({"0":{},"a":{"y":[1,"x"],"z":[]},"b":1})");
  EXPECT_EQ(json.dump(Json::Style::kAsMade), R"({"b":1,"a":{"z":[],"y":[1,"x"]},"0":{}})");
  EXPECT_EQ(json.dump(Json::Style::kLines),
            "{\n  \"b\": 1,\n  \"a\": {\n    \"z\": [],\n    \"y\": [\n      1,\n      \"x\"\n    ]\n  },\n"
            "  \"0\": {}\n}");
  EXPECT_EQ(json.dump(Json::Style::kSpaced), R"({"b": 1, "a": {"z": [], "y": [1, "x"]}, "0": {}})");
  const Json copy = json;
  EXPECT_EQ(copy.dump(Json::Style::kAsMade), json.dump(Json::Style::kAsMade));
}

TEST(Json, KeepsEveryNumber) {
  for (const char* text :
       {"0", "-1", "9223372036854775807", "-9223372036854775808", "9223372036854775808", "18446744073709551615", "-0.0",
        "1.0", "0.1", "1e+300", "-1e-07", "5e-324", "1.7976931348623157e+308", "123456.789"})
    EXPECT_EQ(again(text), text);
  EXPECT_EQ(again("-0"), "0");
  EXPECT_EQ(again("1E2"), "100.0");
  EXPECT_EQ(again("18446744073709551616"), "1.8446744073709552e+19") << "a fraction where no whole number can hold it";
  EXPECT_EQ(again("-9223372036854775809"), "-9.223372036854776e+18");
  EXPECT_EQ(Json(UINT64_MAX).dump(), "18446744073709551615");
  EXPECT_EQ(Json(std::numeric_limits<double>::quiet_NaN()).dump(), "null");
  EXPECT_EQ(Json(-std::numeric_limits<double>::infinity()).dump(), "null");
}

TEST(Json, ConvertsANumberBeyondTheRangeToTheLimit) {
  EXPECT_EQ(Json(-2.9).as_int64(), -2);
  EXPECT_EQ(Json(1e300).as_int64(), INT64_MAX);
  EXPECT_EQ(Json(-1e300).as_int64(), INT64_MIN);
  EXPECT_EQ(Json(UINT64_MAX).as_int64(), INT64_MAX);
  EXPECT_EQ(Json(std::nan("")).as_int64(), INT64_MIN);
  EXPECT_EQ(Json(-1).as_uint64(), 0u);
  EXPECT_EQ(Json(0.5).as_uint64(), 0u);
  EXPECT_EQ(Json(1e19).as_uint64(), 10'000'000'000'000'000'000u);
  EXPECT_EQ(Json(1e300).as_uint64(), UINT64_MAX);
  EXPECT_EQ(Json(std::nan("")).as_uint64(), 0u);
  EXPECT_EQ(Json(7u).as_double(), 7.0);
  EXPECT_EQ(Json(UINT64_MAX).as_double(), 18446744073709551616.0);
}

TEST(Json, EscapesStringsAndReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(Json("a\"\\/\b\f\n\r\t\x01\x7f").dump(), "\"a\\\"\\\\/\\b\\f\\n\\r\\t\\u0001\x7f\"");
  EXPECT_EQ(Json(std::string_view("\0", 1)).dump(), R"("\u0000")");
  EXPECT_EQ(Json("µm 😀").dump(), "\"µm 😀\"");
  EXPECT_EQ(again(R"("\u00b5\ud83d\ude00\/")"), "\"µ😀/\"");
  EXPECT_EQ(Json("a\xff"
                 "b")
                .dump(),
            "\"a\xef\xbf\xbd"
            "b\"");
  EXPECT_EQ(Json("\xe2\x82").dump(), "\"\xef\xbf\xbd\"");
  EXPECT_EQ(Json({{"\xff", 1}}).dump(), "{\"\xef\xbf\xbd\":1}");
}

TEST(Json, RefusesTextThatIsNoJson) {
  EXPECT_TRUE(refusal("").starts_with("parse error at line 1, column 1: ")) << refusal("");
  EXPECT_TRUE(refusal("{\n\"a\" 1}").starts_with("parse error at line 2, column 5: ")) << refusal("{\n\"a\" 1}");
  EXPECT_EQ(refusal("1e999"), "number overflow parsing '1e999'");
  for (const char* text : {"[1,]", "{\"a\":1,}", "nul", "01", "1.", "+1", "NaN", "'a'", "\"\n\"", "\"\xff\"",
                           "\"\\ud800\"", "[1] 2", "// 1\n1", "{a:1}"}) {
    EXPECT_NE(refusal(text), "") << text;
    EXPECT_FALSE(Json::parse_or_none(text)) << text;
  }
  EXPECT_EQ(Json::parse_or_none("[1]"), Json::array({1}));
}

TEST(Json, RefusesNestingDeeperThan500) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_EQ(Json::parse(nested(500)).dump(), nested(500));
  EXPECT_EQ(refusal(nested(501)), "nested deeper than 500");
  EXPECT_EQ(refusal(std::string(1'000'000, '[')), "nested deeper than 500");
  std::string objects;
  for (int i = 0; i < 501; ++i) objects += "{\"a\":";
  EXPECT_EQ(refusal(objects), "nested deeper than 500");
}

TEST(Json, KeepsTheLastOfEqualKeysAndReportsTheFirstSuchKey) {
  std::optional<std::string> twice;
  const Json json = Json::parse(R"({"a": 1, "b": {"c": 1, "c": [2]}, "a": 3})", &twice);
  EXPECT_EQ(json.dump(), R"({"a":3,"b":{"c":[2]}})");
  EXPECT_EQ(twice, "c");
  twice.reset();
  (void)Json::parse(R"([{"a": 1}, {"a": {"a": 2}}])", &twice);
  EXPECT_FALSE(twice) << "equal keys of several objects";
}

TEST(Json, MakesAnObjectOfPairsAndAnArrayOfOtherItems) {
  EXPECT_EQ(Json({{"a", 1}, {"b", {{"c", nullptr}}}}).dump(), R"({"a":1,"b":{"c":null}})");
  EXPECT_EQ(Json({"a", 1}).dump(), R"(["a",1])");
  EXPECT_EQ(Json({{1, "a"}, {"b", 2}}).dump(), R"([[1,"a"],["b",2]])");
  EXPECT_EQ(Json::array({{"a", 1}}).dump(), R"([["a",1]])");
  const Json inner = {{"k", 1}};
  EXPECT_EQ(Json({{"a", inner}, {"b", inner}}).dump(), R"({"a":{"k":1},"b":{"k":1}})");
  EXPECT_EQ(inner.dump(), R"({"k":1})") << "a named value is copied";
  EXPECT_EQ(Json(std::vector<std::string>{"x", "y"}).dump(), R"(["x","y"])");
}

TEST(Json, CopiesDeeplyAndAssignsPartsOfItself) {
  Json json = {{"a", {1, 2}}};
  Json copy = json;
  copy["a"].push_back(3);
  EXPECT_EQ(json.dump(), R"({"a":[1,2]})");
  json["b"] = json["a"];
  json["a"] = json;
  EXPECT_EQ(json.dump(), R"({"a":{"a":[1,2],"b":[1,2]},"b":[1,2]})");
  json = Json(json["a"]);
  json = *&json;
  EXPECT_EQ(json.dump(), R"({"a":[1,2],"b":[1,2]})");
  const Json taken = std::move(json);
  EXPECT_EQ(taken.size(), 2u);
}

TEST(Json, KeepsReferencesToMembersWhileAnObjectGrows) {
  Json json;
  Json& first = json["m"];
  for (int i = 0; i < 1000; ++i) json[std::to_string(i)] = i;
  first = "kept";
  EXPECT_EQ(json["m"], "kept");
  std::string before;
  for (const auto& [key, value] : json.items()) {
    EXPECT_LT(before, key);
    before = key;
  }
  EXPECT_EQ(json.size(), 1001u);
}

TEST(Json, ReadsAMissingPartAsNull) {
  const Json json = {{"a", {1}}, {"n", nullptr}};
  EXPECT_TRUE(json["x"]["y"][3].is_null());
  EXPECT_TRUE(json["a"][1].is_null());
  EXPECT_EQ(json.find("x"), nullptr);
  EXPECT_TRUE(json.contains("n"));
  EXPECT_TRUE(Json(3).empty());
  EXPECT_EQ(Json("text").begin(), Json("text").end());
  EXPECT_EQ(text_at(json, "a", "otherwise"), "otherwise");
  EXPECT_EQ(whole_at(Json{{"w", -3}}, "w"), -3);
  EXPECT_EQ(whole_at(Json{{"w", 0.5}}, "w", 7), 7);
  EXPECT_TRUE(truth_at(Json{{"t", true}}, "t"));
  EXPECT_TRUE(truth_at(json, "t", true));
}

TEST(Json, RefusesToReadAnotherKind) {
  const Json json = {{"a", {1}}};
  EXPECT_EQ(refusal_of([&] { (void)json["a"].as_string(); }), "expected a text, found a list");
  EXPECT_EQ(refusal_of([&] { (void)json["x"].as_int64(); }), "expected a number, found null");
  EXPECT_EQ(refusal_of([&] { (void)json.as_uint64(); }), "expected a number, found an object");
  EXPECT_EQ(refusal_of([&] { (void)Json("1").as_double(); }), "expected a number, found a text");
  EXPECT_EQ(refusal_of([&] { (void)Json(1).as_bool(); }), "expected true or false, found a number");
  EXPECT_EQ(refusal_of([&] { (void)Json(true).as_strings(); }), "expected a list of texts, found a truth value");
  EXPECT_EQ(refusal_of([&] { (void)json.at("b"); }), "the key 'b' is missing");
  Json number = 1, list = Json::array({1});
  EXPECT_EQ(refusal_of([&] { number["a"] = 1; }), "expected an object, found a number");
  EXPECT_EQ(refusal_of([&] { number.push_back(1); }), "expected a list, found a number");
  EXPECT_EQ(refusal_of([&] { list[1] = 1; }), "expected a longer list, found a list");
}

TEST(Json, ComparesNumbersByValueAndObjectsByKey) {
  EXPECT_EQ(Json(1), Json(1.0));
  EXPECT_EQ(Json(1u), Json(1));
  EXPECT_NE(Json(UINT64_MAX), Json(-1));
  EXPECT_NE(Json(1), Json(true));
  EXPECT_NE(Json("1"), Json(1));
  EXPECT_EQ(Json({{"a", 1}, {"b", 2}}), Json({{"b", 2}, {"a", 1}}));
  EXPECT_NE(Json({{"a", 1}}), Json({{"b", 1}}));
  EXPECT_NE(Json::array({1}), Json::array({1, 2}));
  std::ostringstream out;
  out << Json::array({1, "a"});
  EXPECT_EQ(out.str(), R"([1,"a"])");
}

TEST(Json, WritesNumbersAndStringsAsTheLibraryDoes) {
  const auto seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t bits = random();
    const auto number = std::bit_cast<double>(bits);
    ASSERT_EQ(Json(number).dump(), nlohmann::json(number).dump()) << bits;
    ASSERT_EQ(Json(static_cast<double>(bits % 100'000) / 1000).dump(),
              nlohmann::json(static_cast<double>(bits % 100'000) / 1000).dump());
    std::string text;
    for (std::uint64_t n = bits % 12; n > 0; --n) text += static_cast<char>(random() % (n % 3 == 0 ? 256 : 128));
    ASSERT_EQ(Json(text).dump(), nlohmann::json(text).dump(-1, ' ', false, kReplace)) << bits;
  }
}

TEST(Json, ParsesAsTheLibraryDoes) {
  const auto seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  constexpr std::string_view kParts[] = {"{",    "}",     "[",     "]",           ",",
                                         ":",    "\"a\"", "\"b\"", "1",           "-2.5e3",
                                         "true", "null",  " ",     "\"\\u00e4\"", "18446744073709551615"};
  int n_good = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string text = i % 2 == 0 ? "[" : "{\"a\":";
    for (auto n = random() % 8; n > 0; --n) text += kParts[random() % std::size(kParts)];
    text += i % 2 == 0 ? "]" : "}";
    const nlohmann::json expected = nlohmann::json::parse(text, nullptr, false);
    const std::optional<Json> found = Json::parse_or_none(text);
    ASSERT_EQ(found.has_value(), !expected.is_discarded()) << text;
    if (!found) continue;
    ASSERT_EQ(found->dump(), expected.dump()) << text;
    ++n_good;
  }
  EXPECT_GT(n_good, 100);
}

}  // namespace
}  // namespace chimera
