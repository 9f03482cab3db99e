// SPDX-License-Identifier: Apache-2.0
#include "chimera/description/edit_json.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

/// "acts/2/path: message", or "" if the acts are read.
std::string refused(const std::string& json) {
  const auto parsed = Json::parse_or_none(json);
  if (!parsed) return "no JSON";
  const auto read = edit_acts(*parsed);
  return read ? "" : std::string(read.error().where.view()) + ": " + std::string(read.error().message.view());
}

const std::vector<EditAct> kAll = {SetValue{{"tasks", "pid", "rate"}, "1 kHz"},
                                   RemoveValue{{"operator", "x"}},
                                   RenameKey{{"tasks", "a"}, "b", {{"c", "d"}, {"e", "f"}}},
                                   AddTask{"e", "f"},
                                   AddTask{"e", "f", "arm"},
                                   LinkPort{"g", "h", "i", 2},
                                   LinkPort{"g", "h", "i", std::nullopt},
                                   JoinProducers{"j", JoinBy::kMean, {}},
                                   JoinProducers{"j", JoinBy::kPriority, {{"k", "l"}}},
                                   JoinProducers{"j", JoinBy::kSelect, {{"k", "l"}}}};

TEST(EditJson, EachActComesBackAsItWas) {
  const Json written = edits_json(kAll);
  const auto read = edit_acts(Json::parse(written.dump()));
  ASSERT_TRUE(read) << read.error().message.c_str();
  ASSERT_EQ(read->size(), kAll.size());
  for (std::size_t i = 0; i < kAll.size(); ++i) EXPECT_EQ((*read)[i].index(), kAll[i].index());
  EXPECT_EQ(edits_json(*read), written);
  EXPECT_EQ(std::get<AddTask>((*read)[3]).subsystem, "untitled");
}

TEST(EditJson, KnowsWhichPortsAreLeftOut) {
  const auto read = edit_acts(Json::parse(
      R"([{"act": "rename", "path": "operator/x", "to": "y"}, {"act": "rename", "path": "a/b", "to": "y", "ports": []},
          {"act": "join", "variable": "v", "by": "mean"}, {"act": "join", "variable": "v", "by": "mean",
           "producers": []}])"));
  ASSERT_TRUE(read) << read.error().message.c_str();
  EXPECT_TRUE(std::get<RenameKey>((*read)[0]).lacks_ports);
  EXPECT_FALSE(std::get<RenameKey>((*read)[1]).lacks_ports);
  EXPECT_TRUE(std::get<JoinProducers>((*read)[2]).lacks_ports);
  EXPECT_FALSE(std::get<JoinProducers>((*read)[3]).lacks_ports);
}

TEST(EditJson, RefusesWithThePlace) {
  EXPECT_EQ(refused("{}"), "acts: expected an array of acts");
  EXPECT_EQ(refused("[1]"), "acts/0: expected an object");
  EXPECT_EQ(refused("[{}]"), "acts/0/act: there is no 'act'");
  EXPECT_EQ(refused(R"([{"act": "sett"}])"), "acts/0/act: expected set, remove, rename, add_task, link or join");
  EXPECT_EQ(refused(R"([{"act": "remove", "path": "a"}, {"act": "set", "value": "1"}])"),
            "acts/1/path: there is no 'path'");
  EXPECT_EQ(refused(R"([{"act": "set", "path": "a", "value": 1}])"), "acts/0/value: expected a text");
  EXPECT_EQ(refused(R"([{"act": "remove", "path": "a", "paht": "b"}])"),
            "acts/0/paht: no key 'paht'; did you mean 'path'?");
  EXPECT_EQ(refused(R"([{"act": "join", "variable": "v", "by": "sum"}])"),
            "acts/0/by: expected mean, priority or select");
  EXPECT_EQ(refused(R"([{"act": "rename", "path": "a", "to": "b", "ports": {}}])"), "acts/0/ports: expected an array");
  EXPECT_EQ(refused(R"([{"act": "rename", "path": "a", "to": "b", "ports": [{"task": "t", "port": 1}]}])"),
            "acts/0/ports/0/port: expected a text");
  EXPECT_EQ(refused(R"([{"act": "rename", "path": "a", "to": "b", "ports": [{"task": "t", "port": "p", "x": 1}]}])"),
            "acts/0/ports/0/x: no key 'x'");
}

TEST(EditJson, RefusesAnInstanceThatIsNoWholeNumber) {
  const std::string begin = R"([{"act": "link", "task": "t", "port": "p", "variable": "v", "instance": )";
  for (const char* good : {"null", "0", "15", "18446744073709551615"}) EXPECT_EQ(refused(begin + good + "}]"), "");
  for (const char* bad : {"-1", "1.5", "1e300", "\"1\"", "true", "[]", "{}", "-9223372036854775808"})
    EXPECT_EQ(refused(begin + bad + "}]"), "acts/0/instance: expected null or a whole number from 0 on") << bad;
}

TEST(EditJson, RefusesEachKeyOfEachActThatIsMissingOrOfAnotherKind) {
  const Json hostile[] = {Json(), Json(true), Json(-1), Json(1e300), Json::array(), Json::object(),
                          Json::parse(std::string(400, '[') + std::string(400, ']')), Json(std::string(100'000, '/'))};
  for (const EditAct& act : kAll) {
    const Json good = edit_json(act);
    for (const auto& [key, value] : good.items()) {
      Json without = Json::object();
      for (const auto& [other, kept] : good.items())
        if (other != key) without[other] = kept;
      const bool may_lack = key == "ports" || key == "producers" || key == "instance" || key == "subsystem";
      EXPECT_EQ(edit_acts(Json::array({without})).has_value(), may_lack) << key << good;
      for (const Json& wrong : hostile) {
        Json changed = good;
        changed[key] = wrong;
        const bool is_text = value.is_string() && key != "act" && key != "by";
        const bool may_be = (is_text && wrong.is_string()) || (key == "instance" && wrong.is_null()) ||
                            ((key == "ports" || key == "producers") && wrong == Json::array());
        EXPECT_EQ(edit_acts(Json::array({changed})).has_value(), may_be) << key << good;
      }
    }
  }
}

}  // namespace
}  // namespace chimera
