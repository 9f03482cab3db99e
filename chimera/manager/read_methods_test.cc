// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/read_methods.h"

#include <gtest/gtest.h>

#include "chimera/manager/testing/lone_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

using control::MethodId;
using control::RpcResponse;

class ReadMethodsTest : public ::testing::Test, public LoneState {
 protected:
  std::optional<RpcResponse> ask(MethodId method, const Json& parameters = Json::object()) {
    return reads_.answer(method, parameters, control::Role::kObserve);
  }
  ReadMethods reads_{state()};
};

TEST_F(ReadMethodsTest, AnswersOnlyMethodsThatChangeNothing) {
  std::string answered;
  for (const control::MethodRule& rule : control::methods()) {
    const Json parameters = rule.id == MethodId::kWhy ? Json{{"variable", "x"}} : Json::object();
    if (ask(rule.id, parameters)) answered += std::string(rule.name) + " ";
  }
  EXPECT_EQ(answered, "hello status describe get profile events why library text ");
}

TEST_F(ReadMethodsTest, HelloNamesTheRoleOfTheClient) {
  EXPECT_EQ((*ask(MethodId::kHello)->result)["role"], "observe");
  EXPECT_EQ((*reads_.answer(MethodId::kHello, Json::object(), control::Role::kOperate)->result)["role"], "operate");
}

TEST_F(ReadMethodsTest, BuildsEachTextOfTheBundleOnce) {
  const auto first = ask(MethodId::kDescribe)->text;
  EXPECT_EQ(Json::parse(*first)["start"], "run");
  EXPECT_EQ(ask(MethodId::kDescribe)->text, first);
  const auto library = ask(MethodId::kLibrary)->text;
  EXPECT_NE(*library, *first);
  EXPECT_EQ(ask(MethodId::kLibrary)->text, library);
}

TEST_F(ReadMethodsTest, HandsOutTheTextThatRuns) {
  const auto text = ask(MethodId::kText)->text;
  EXPECT_EQ(Json::parse(*text), Json({{"file", "fake.yaml"}, {"text", kFakeText}}));
  EXPECT_EQ(ask(MethodId::kText)->text, text);
}

TEST_F(ReadMethodsTest, DrawsEachPictureOnce) {
  const auto all = ask(MethodId::kDescribe, {{"picture", true}})->text;
  const auto rest = ask(MethodId::kDescribe, {{"picture", true}, {"configuration", "rest"}})->text;
  EXPECT_EQ(Json::parse(*all)["picture"]["boxes"].size(), 3u);
  EXPECT_EQ(Json::parse(*rest)["picture"]["boxes"].size(), 1u);
  EXPECT_EQ(Json::parse(*rest)["tasks"].size(), 3u);
  EXPECT_EQ(ask(MethodId::kDescribe, {{"picture", true}})->text, all);
  EXPECT_EQ(ask(MethodId::kDescribe, {{"picture", true}, {"configuration", "rest"}})->text, rest);
  EXPECT_FALSE(Json::parse(*ask(MethodId::kDescribe, {{"picture", false}})->text).contains("picture"));
}

TEST_F(ReadMethodsTest, RefusesAnUnknownConfigurationAndOneWithoutPicture) {
  const RpcResponse unknown = *ask(MethodId::kDescribe, {{"picture", true}, {"configuration", "rst"}});
  EXPECT_EQ(unknown.code, control::kUnknown);
  EXPECT_EQ(unknown.detail("nearest"), "rest");
  const RpcResponse alone = *ask(MethodId::kDescribe, {{"configuration", "rest"}});
  EXPECT_EQ(alone.code, control::kBadParameters);
  EXPECT_EQ(alone.detail("where"), "configuration");
}

TEST_F(ReadMethodsTest, DescribesOperatorVariablesWithTheRangeThatTheirReadersDeclare) {
  std::string text;
  const Json description = Json::parse(*ask(MethodId::kDescribe)->text);
  for (const Json& each : description["variables"])
    text += each["variable"].as_string() + " " + each["operator"].dump() + " " + each["least"].dump() + " " +
            each["most"].dump() + "\n";
  EXPECT_EQ(text, "kp true 0.0 5000.0\nx false null null\ny false null null\ntau false null null\n");
  EXPECT_EQ(description["tasks"][2]["ports"][0]["frame"], "base");
  EXPECT_EQ(description["tasks"][2]["ports"][1]["frame"], nullptr);
}

TEST_F(ReadMethodsTest, AnUnknownVariableIsRefusedWithTheNearest) {
  const RpcResponse got = *ask(MethodId::kGet, {{"variables", {"kq"}}});
  EXPECT_EQ(got.code, control::kUnknown);
  EXPECT_EQ(got.detail("nearest"), "kp");
  const RpcResponse why = *ask(MethodId::kWhy, {{"variable", "kq"}});
  EXPECT_EQ(why.message, got.message);
}

TEST_F(ReadMethodsTest, WhySaysWhichLinksAreAPeriodLate) {
  std::string late;
  const Json result = *ask(MethodId::kWhy, {{"variable", "tau"}})->result;
  for (const Json& link : result["chain"])
    late += link["variable"].as_string() + ": " + link["late"].as_string() + "\n";
  EXPECT_EQ(late, "tau: \ny: 'law' runs on another rtpu; remedy: rtpu: servo of 'law'\nkp: \nx: \n");
}

TEST_F(ReadMethodsTest, EventsBeginWhereTheyAreAskedForAndEndAtTheLimit) {
  for (const char* text : {"one", "two", "three"}) state().tell("command", TaskId{}, RtpuId{}, text, seconds(1));
  const auto texts = [&](const Json& parameters) {
    std::string all;
    const Json result = *ask(MethodId::kEvents, parameters)->result;
    for (const Json& event : result["events"]) all += event["text"].as_string() + " ";
    return all;
  };
  EXPECT_EQ(texts(Json::object()), "one two three ");
  EXPECT_EQ(texts({{"since", 2}, {"limit", 1}}), "two ");
}

}  // namespace
}  // namespace chimera::manager
