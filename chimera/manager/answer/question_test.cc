// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/answer/question.h"

#include <gtest/gtest.h>

#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

const Library& library() {
  static const Library kLibrary = fake_bundle().library;
  return kLibrary;
}

Result<AnalystAnswer> drafted(const std::string& text, const std::string& acts = "") {
  return answer_of({Question::Kind::kDraft, "a.yaml", text, acts, 3}, library());
}

/// "where: message" of a refused draft.
std::string refused(const std::string& text, const std::string& acts) {
  const auto answer = drafted(text, acts);
  return answer ? "" : std::string(answer.error().where.view()) + ": " + std::string(answer.error().message.view());
}

std::string with(const std::string& text, const std::string& old, const std::string& now) {
  std::string changed = text;
  return changed.replace(changed.find(old), old.size(), now);
}

TEST(QuestionOfADraft, HasTextReportOutlinePictureAndSchedule) {
  const auto answer = drafted(kFakeText);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->edited, kFakeText);
  EXPECT_EQ(answer->json.find('\n'), std::string::npos);
  const Json draft = Json::parse(answer->json);
  EXPECT_EQ(draft["version"], 3);
  EXPECT_EQ(draft["text"], kFakeText);
  EXPECT_EQ(draft["report"]["legal"], true);
  EXPECT_EQ(draft["outline"]["tasks"][2]["task"], "law");
  EXPECT_EQ(draft["picture"]["boxes"].size(), 3u);
  EXPECT_EQ(draft["schedule"]["fits"], true);
  EXPECT_EQ(draft.size(), 6u);
}

TEST(QuestionOfADraft, IsAnsweredAfterTheActs) {
  const auto answer = drafted(kFakeText, R"([{"act": "set", "path": "tasks/law/rate", "value": "20 Hz"},
                                             {"act": "rename", "path": "tasks/law", "to": "rule"}])");
  ASSERT_TRUE(answer) << answer.error().message.c_str();
  EXPECT_EQ(answer->edited,
            with(with(kFakeText, "law:    {rtpu: spare, rate: 10 Hz}",
                      "rule:    {component: law, rtpu: spare, rate: 20 Hz}"),
                 "filter, law]", "filter, rule]"));
  EXPECT_EQ(Json::parse(answer->json)["outline"]["tasks"][2]["rate_hz"], 20);
}

TEST(QuestionOfADraft, TakesFromTheOutlineWhatAnActLeavesOut) {
  const auto renamed = drafted(kFakeText, R"([{"act": "rename", "path": "variables/y", "to": "angle"},
                                              {"act": "rename", "path": "variables/angle", "to": "z"}])");
  ASSERT_TRUE(renamed) << renamed.error().message.c_str();
  EXPECT_NE(renamed->edited.find("filter: {rtpu: servo, rate: 10 Hz, alias: {y: z}}"), std::string::npos)
      << renamed->edited;
  EXPECT_NE(renamed->edited.find("law:    {rtpu: spare, rate: 10 Hz, alias: {y: z}}"), std::string::npos);
  const std::string second = "  second: {component: filter, rtpu: servo, rate: 10 Hz}\n";
  const std::string two = with(kFakeText, "operator:", second + "operator:");
  const auto joined = drafted(two, R"([{"act": "join", "variable": "y", "by": "mean"}])");
  ASSERT_TRUE(joined) << joined.error().message.c_str();
  EXPECT_NE(joined->edited.find("in: [y_1, y_2]"), std::string::npos) << joined->edited;
}

TEST(QuestionOfADraft, RefusesActsThatCannotBeDone) {
  EXPECT_EQ(refused(kFakeText, "[{}]"), "acts/0/act: there is no 'act'");
  EXPECT_EQ(refused(kFakeText, "{"), "acts: expected an array of acts");
  EXPECT_EQ(refused(kFakeText, R"([{"act": "remove", "path": "tasks/lwa"}])"),
            "tasks/lwa: no task 'lwa'; did you mean 'law'?");
  EXPECT_EQ(refused("tasks: [", R"([{"act": "add_task", "name": "a", "component": "b"}])").substr(0, 4), "1:8:");
  EXPECT_EQ(refused(kFakeText, R"([{"act": "join", "variable": "y", "by": "mean"}])"),
            "variables/y: a join needs two producers; name task and port of each");
  std::string deep = "constants";
  for (int i = 0; i < 100'000; ++i) deep += "/a";
  EXPECT_EQ(refused(kFakeText, R"([{"act": "set", "value": "1", "path": ")" + deep + R"("}])"),
            "constants: the path is too deep for a description");
}

TEST(QuestionOfADraft, HasAScheduleIfOnlyBudgetsExceedACpu) {
  const std::string text = with(with(kFakeText, "sensor: {rtpu: servo,", "sensor: {rtpu: servo, budget: 60 ms,"),
                                "filter: {rtpu: servo,", "filter: {rtpu: servo, budget: 60 ms,");
  const Json draft = Json::parse(drafted(text)->json);
  EXPECT_EQ(draft["report"]["legal"], false);
  EXPECT_EQ(draft["report"]["errors"], 1);
  EXPECT_EQ(draft["report"]["faults"][0]["rule"], "utilisation");
  EXPECT_EQ(draft["report"]["faults"][0]["severity"], "error");
  EXPECT_EQ(draft["schedule"]["sets"][0]["cpus"][0]["give_way"].size(), 1u);
  EXPECT_TRUE(Json::parse(drafted(with(text, "law:", "lwa:"))->json)["schedule"].is_null());
}

TEST(QuestionOfADraft, HasNoOutlineIfTheTextIsNoTree) {
  const auto answer = drafted("tasks: [\xFF");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->edited, "tasks: [\xFF");
  const Json draft = Json::parse(answer->json);
  for (const char* key : {"outline", "picture", "schedule"}) EXPECT_TRUE(draft[key].is_null()) << key;
  EXPECT_EQ(draft["report"]["legal"], false);
}

TEST(QuestionOfOffers, NamesEachFaultByItsNumberInTheReport) {
  const std::string text = with(with(kFakeText, "start: run", "start: rnu"), "rate: 10 Hz}", "raet: 10 Hz}");
  const auto answer = answer_of({Question::Kind::kOffers, "a.yaml", text, "", 4}, library());
  const Json report = Json::parse(drafted(text)->json)["report"];
  ASSERT_EQ(report["faults"].size(), 2u) << report;
  EXPECT_EQ(answer->json,
            R"({"version":4,"offers":[{"fault":0,"label":"rename to 'rate'","acts":[{"act":"rename",)"
            R"("path":"tasks/sensor/raet","to":"rate","ports":[]}]},{"fault":1,"label":"write 'run'",)"
            R"("acts":[{"act":"set","path":"start","value":"run"}]}]})");
}

TEST(QuestionOfModes, HasTheTransitionsOfALegalTextOnly) {
  const auto asked = [](const std::string& text) {
    return Json::parse(answer_of({Question::Kind::kModes, "a.yaml", text, "", 4}, library())->json);
  };
  const Json legal = asked(kFakeText), faulty = asked(with(kFakeText, "start: run", "start: rnu"));
  EXPECT_EQ(legal["version"], 4);
  EXPECT_EQ(legal["modes"]["transitions"].size(), 2u) << legal;
  EXPECT_EQ(legal["modes"]["transitions"][0]["to"], "rest");
  EXPECT_EQ(faulty.dump(), R"({"modes":null,"version":4})");
}

/// The paths at which the texts differ.
std::string differ(const std::string& a, const std::string& b) {
  const auto answer = answer_of({Question::Kind::kDifferences, "", a, b, 5}, library());
  if (!answer) return std::string(answer.error().where.view()) + ": " + std::string(answer.error().message.view());
  EXPECT_TRUE(answer->json.starts_with(R"({"version":5,"paths":)"));
  return Json::parse(answer->json)["paths"].dump();
}

TEST(QuestionOfDifferences, NamesKeysTwoDeep) {
  EXPECT_EQ(differ(kFakeText, kFakeText), "[]");
  EXPECT_EQ(differ(kFakeText, with(kFakeText, "law:    {rtpu: spare, rate: 10 Hz}", "law:    {rtpu: spare}")),
            R"(["tasks/law"])");
  EXPECT_EQ(differ(kFakeText, with(kFakeText, "start: run", "")), R"(["start"])");
  EXPECT_EQ(differ("operator: {a: 1, b: 2}", "constants: {c: 1}\noperator: {b: 2}"), R"(["operator/a","constants/c"])");
  EXPECT_EQ(differ("operator: {a: 1}", "operator: 1"), R"(["operator"])");
  EXPECT_EQ(differ("", "subsystem: a\noperator: {a: [1]}"), R"(["subsystem","operator/a"])");
}

TEST(QuestionOfDifferences, AcceptsOtherUnitsAndAnotherOrderAndComments) {
  EXPECT_EQ(differ("operator: {a: 1 m, b: [1 Hz, 2]}", "# new\noperator:\n  b: [1 Hz, 2]\n  a: 100 cm\n"), "[]");
  EXPECT_EQ(differ("operator: {a: 1 m}", "operator: {a: 101 cm}"), R"(["operator/a"])");
}

TEST(QuestionOfDifferences, RefusesATextThatCannotBeRead) {
  EXPECT_TRUE(differ("a: [", "").starts_with("1:4: the text cannot be read: ")) << differ("a: [", "");
  EXPECT_TRUE(differ("", "a: [").starts_with("1:4: the other text cannot be read: ")) << differ("", "a: [");
  EXPECT_EQ(differ("a: 1", "[1]"), "1:1: the other text cannot be read: it has no keys");
}

}  // namespace
}  // namespace chimera::manager
