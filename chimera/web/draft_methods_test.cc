// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/draft_methods.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "chimera/text/json.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;
using control::MethodId;
using control::RpcResponse;
using manager::Question;

/// Answers when the test says so.
struct FakeAnalyst final : Analyst {
  struct Asked {
    Question question;
    std::uint64_t connection = 0;
    Take take;
  };
  std::uint64_t library() override { return version; }
  void ask(Question question, std::uint64_t connection, Take take) override {
    asked.push_back({std::move(question), connection, std::move(take)});
  }
  /// Answers the first question: acts, if there are some, append a line.
  void answer() {
    const Asked one = next();
    const std::string edited = one.question.text + (one.question.with.empty() ? "" : "# edited\n");
    const Json analysis{{"version", one.question.version}, {"text", edited}};
    one.take(RpcResponse::ready(std::make_shared<const std::string>(analysis.dump())), edited);
  }
  void refuse(const RpcResponse& refusal) { next().take(refusal, {}); }
  Asked next() {
    Asked first = std::move(asked.front());
    asked.erase(asked.begin());
    return first;
  }

  std::uint64_t version = 1;
  std::vector<Asked> asked;
};

/// The answer with the member that is sent in pieces.
Json whole(const RpcResponse& answer) {
  if (!answer.is_good()) return *answer.data;
  std::string text;
  if (answer.pieces != nullptr)
    while (answer.pieces->append_to(text)) {
    }
  return answer.pieces != nullptr ? Json::parse(text) : answer.text ? Json::parse(*answer.text) : *answer.result;
}

const Json kActs = Json::array({{{"act", "remove"}, {"path", "start"}}});
const RpcResponse kDied = RpcResponse::refused("analysis", "the analysis failed", "text");

struct DraftMethodsTest : ::testing::Test {
  DraftMethodsTest() : place(::mkdtemp(made)) {
    write_file("a: 1\n");
    begin();
  }
  ~DraftMethodsTest() override { fs::remove_all(place); }
  void begin() {
    draft.reset();
    draft.emplace(path, place + "/state/drafts", analyst, clock, [this](const std::string& text) { told += text; });
  }
  void write_file(const std::string& text) const { std::ofstream(path) << text; }
  std::string file_text() const {
    std::ostringstream all;
    all << std::ifstream(path).rdbuf();
    return all.str();
  }
  void pass(Nanoseconds span) {
    clock.advance(span);
    draft->serve();
  }
  /// The answers of a call come here, those of later ones behind.
  void ask(MethodId method, const Json& parameters = Json::object(), std::uint64_t connection = 1) {
    draft->call(method, parameters, {control::Role::kConfigure, connection, 0},
                [this](const RpcResponse& given) { answers.push_back(given); });
  }
  /// The one answer of a call, after the analyst has answered.
  Json call(MethodId method, const Json& parameters = Json::object()) {
    answers.clear();
    ask(method, parameters);
    while (answers.empty() && !analyst.asked.empty()) analyst.answer();
    return answers.size() == 1 ? whole(answers[0]) : Json();
  }
  Json edit(std::uint64_t version) { return call(MethodId::kEdit, {{"version", version}, {"acts", kActs}}); }
  std::string note() { return draft->note().dump(Json::Style::kAsMade); }
  std::size_t kept() const {
    std::error_code none;
    std::size_t n = 0;
    for (fs::directory_iterator at(place + "/state/drafts", none), end; !none && at != end; ++at) ++n;
    return n;
  }

  char made[40] = "/tmp/chimera_draft_XXXXXX";
  std::string place, path = place + "/arm.yaml", told;
  VirtualClock clock{seconds(1)};
  FakeAnalyst analyst;
  std::optional<DraftMethods> draft;
  std::vector<RpcResponse> answers;
};

TEST_F(DraftMethodsTest, OneAnalysisOfAVersionServesAllPages) {
  ask(MethodId::kDraft, Json::object(), 1);
  ask(MethodId::kDraft, Json::object(), 2);
  ASSERT_EQ(analyst.asked.size(), 1u);
  EXPECT_EQ(analyst.asked[0].question.kind, Question::Kind::kDraft);
  EXPECT_EQ(analyst.asked[0].question.file, path);
  analyst.answer();
  ask(MethodId::kDraft, Json::object(), 3);
  EXPECT_TRUE(analyst.asked.empty());
  ASSERT_EQ(answers.size(), 3u);
  for (const RpcResponse& answer : answers)
    EXPECT_EQ(whole(answer).dump(Json::Style::kAsMade),
              "{\"version\":1,\"file\":\"" + path + "\",\"exists\":true,\"touched\":false,\"outside\":false,"
              "\"problem\":null,\"analysis\":{\"text\":\"a: 1\\n\",\"version\":1}}");
  analyst.version = 2;
  ask(MethodId::kDraft);
  EXPECT_EQ(analyst.asked.size(), 1u) << "other components, other answers";
}

TEST_F(DraftMethodsTest, AnEditChangesTheDraftWhenTheAnalystHasReadIt) {
  ask(MethodId::kEdit, {{"version", 1}, {"acts", kActs}});
  EXPECT_EQ(analyst.asked[0].question.with, R"([{"act":"remove","path":"start"}])");
  EXPECT_EQ(analyst.asked[0].question.version, 2u);
  EXPECT_EQ(draft->note()["version"], Json(1));
  analyst.answer();
  const Json edited = whole(answers.at(0));
  EXPECT_EQ(edited["version"], Json(2));
  EXPECT_EQ(edited["touched"], Json(true));
  EXPECT_EQ(edited["analysis"]["text"], Json("a: 1\n# edited\n"));
  EXPECT_EQ(edited["analysis"]["version"], Json(2));
  EXPECT_EQ(call(MethodId::kDraft), edited) << "without another question";
  EXPECT_EQ(file_text(), "a: 1\n");
}

TEST_F(DraftMethodsTest, OfTwoEditsOfOneVersionTheSecondIsStale) {
  ask(MethodId::kEdit, {{"version", 1}, {"acts", kActs}}, 1);
  ask(MethodId::kReplace, {{"version", 1}, {"text", "b: 2\n"}}, 2);
  analyst.answer();
  analyst.answer();
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_TRUE(answers[0].is_good());
  EXPECT_EQ(whole(answers[1]).dump(), R"({"kind":"stale","version":2,"where":"version"})");
  for (const MethodId method :
       {MethodId::kEdit, MethodId::kReplace, MethodId::kRemedies, MethodId::kTransitions, MethodId::kWrite})
    EXPECT_EQ(call(method, {{"version", 1}, {"acts", kActs}, {"text", ""}})["kind"], Json("stale"));
  EXPECT_EQ(call(MethodId::kDraft)["analysis"]["text"], Json("a: 1\n# edited\n"));
}

TEST_F(DraftMethodsTest, ATextThatEndsTheAnalystCostsOneEdit) {
  for (const MethodId method : {MethodId::kEdit, MethodId::kReplace}) {
    ask(method, {{"version", 1}, {"acts", kActs}, {"text", "fatal"}});
    analyst.refuse(kDied);
    EXPECT_EQ(answers.back().message, "the analysis failed");
  }
  EXPECT_EQ(draft->note()["version"], Json(1));
  EXPECT_EQ(edit(1)["version"], Json(2));
}

TEST_F(DraftMethodsTest, WithoutAnAnalysisADraftHasItsText) {
  ask(MethodId::kDraft);
  analyst.refuse(kDied);
  const Json answer = whole(answers.at(0));
  EXPECT_EQ(answer["problem"], Json("the analysis failed"));
  EXPECT_EQ(answer["analysis"]["text"], Json("a: 1\n"));
  EXPECT_EQ(answer["analysis"]["version"], Json(1));
  EXPECT_EQ(answer["analysis"]["report"]["legal"], Json(false));
  EXPECT_TRUE(answer["analysis"]["outline"].is_null());
  ask(MethodId::kDraft);
  analyst.refuse(RpcResponse::error(control::kTooFast, "too many", {{"retry_ms", 100}}));
  EXPECT_EQ(answers.at(1).code, control::kTooFast);
  EXPECT_EQ(call(MethodId::kDraft)["problem"], Json()) << "the next one is asked again";
}

TEST_F(DraftMethodsTest, APageGetsTheTextThatFileHasWhenTheAnswerComes) {
  ask(MethodId::kDraft);
  write_file("b: 2\n");
  clock.advance(DraftFile::kPeriod);
  EXPECT_EQ(draft->note()["version"], Json(2));
  analyst.answer();
  EXPECT_TRUE(answers.empty()) << "the answer is of another text";
  analyst.answer();
  const Json answer = whole(answers.at(0));
  EXPECT_EQ(answer["analysis"]["text"], Json("b: 2\n"));
  EXPECT_EQ(answer["version"], Json(2));
}

TEST_F(DraftMethodsTest, AnEditOfAPageThatClosesIsCarriedOut) {
  ask(MethodId::kEdit, {{"version", 1}, {"acts", kActs}}, 7);
  ask(MethodId::kDraft, Json::object(), 7);
  draft->forget(7);
  for (const auto& one : analyst.asked) EXPECT_NE(one.connection, 7u) << "the analyst forgets questions of 7";
  analyst.answer();
  EXPECT_EQ(draft->note()["version"], Json(2));
  analyst.answer();
  EXPECT_EQ(answers.size(), 1u);
}

TEST_F(DraftMethodsTest, RefusesTheSixtyFifthThatWaits) {
  for (std::size_t i = 0; i <= DraftMethods::kMaxWaiters; ++i) ask(MethodId::kDraft, Json::object(), i);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].code, control::kTooFast);
  EXPECT_EQ(analyst.asked.size(), 1u);
}

TEST_F(DraftMethodsTest, WritesTheDraftOnce) {
  EXPECT_EQ(call(MethodId::kWrite, {{"version", 1}})["changed"], Json(false));
  (void)edit(1);
  const Json written = call(MethodId::kWrite, {{"version", 2}});
  EXPECT_EQ(written.dump(), "{\"changed\":true,\"file\":\"" + path + "\",\"version\":2}");
  EXPECT_EQ(file_text(), "a: 1\n# edited\n");
  EXPECT_EQ(draft->note()["touched"], Json(false));
  EXPECT_EQ(call(MethodId::kWrite, {{"version", 2}})["changed"], Json(false));
}

TEST_F(DraftMethodsTest, WritesOverNoChangeOfAnotherProgram) {
  (void)edit(1);
  write_file("theirs\n");  // not seen yet
  EXPECT_EQ(call(MethodId::kWrite, {{"version", 2}})["kind"], Json("outside"));
  EXPECT_EQ(draft->note()["outside"], Json(true));
  EXPECT_EQ(file_text(), "theirs\n");
  EXPECT_EQ(call(MethodId::kKeep, {{"what", "draft"}})["outside"], Json(false));
  EXPECT_EQ(call(MethodId::kWrite, {{"version", 2}})["changed"], Json(true));
  EXPECT_EQ(file_text(), "a: 1\n# edited\n");
  (void)edit(2);
  write_file("theirs again\n");
  const Json taken = call(MethodId::kKeep, {{"what", "file"}});
  EXPECT_EQ(taken["version"], Json(4));
  EXPECT_EQ(taken["touched"], Json(false));
  EXPECT_EQ(taken["analysis"]["text"], Json("theirs again\n"));
}

TEST_F(DraftMethodsTest, MakesFileOnlyIfThereIsNone) {
  fs::remove(path);
  begin();
  EXPECT_EQ(draft->note()["exists"], Json(false));
  EXPECT_EQ(call(MethodId::kKeep, {{"what", "file"}})["kind"], Json("file"));
  (void)call(MethodId::kReplace, {{"version", 1}, {"text", "b: 2\n"}});
  write_file("theirs\n");
  EXPECT_EQ(call(MethodId::kWrite, {{"version", 2}})["kind"], Json("outside"));
  fs::remove(path);
  EXPECT_EQ(call(MethodId::kWrite, {{"version", 2}})["changed"], Json(true));
  EXPECT_EQ(file_text(), "b: 2\n");
  EXPECT_EQ(draft->note()["exists"], Json(true));
}

TEST_F(DraftMethodsTest, AFileThatCannotBeReadIsAProblemAndIsNotWritten) {
  (void)edit(1);
  fs::remove(path);
  fs::create_directory(path);
  clock.advance(DraftFile::kPeriod);
  EXPECT_EQ(draft->note()["problem"], Json(path + ": is no ordinary file but a folder"));
  for (const auto& [method, parameters] :
       {std::pair(MethodId::kWrite, Json{{"version", 2}}), {MethodId::kKeep, Json{{"what", "draft"}}},
        {MethodId::kKeep, Json{{"what", "file"}}}, {MethodId::kDifferences, Json::object()}})
    EXPECT_EQ(call(method, parameters)["kind"], Json("file")) << parameters;
  EXPECT_EQ(draft->may_start().detail("kind"), "file");
  EXPECT_EQ(call(MethodId::kDraft)["analysis"]["text"], Json("a: 1\n# edited\n"));
}

TEST_F(DraftMethodsTest, KeepsATouchedDraftWithin300MsAndGoesOnWithIt) {
  EXPECT_EQ(draft->next_due(), kNever);
  (void)edit(1);
  EXPECT_LE(draft->next_due(), clock.now() + milliseconds(300));
  pass(milliseconds(100));
  (void)edit(2);
  pass(milliseconds(200));
  EXPECT_EQ(draft->next_due(), kNever);
  EXPECT_EQ(kept(), 1u);
  begin();
  EXPECT_EQ(call(MethodId::kDraft)["analysis"]["text"], Json("a: 1\n# edited\n# edited\n"));
  EXPECT_EQ(draft->note()["outside"], Json(false));
  write_file("theirs\n");
  begin();
  EXPECT_EQ(draft->note()["outside"], Json(true)) << "FILE changed while no server ran";
  (void)call(MethodId::kKeep, {{"what", "file"}});
  pass(milliseconds(300));
  EXPECT_EQ(kept(), 0u);
  EXPECT_EQ(told, "");
}

TEST_F(DraftMethodsTest, AWrittenDraftIsNotKept) {
  (void)edit(1);
  pass(milliseconds(300));
  (void)call(MethodId::kWrite, {{"version", 2}});
  EXPECT_EQ(kept(), 0u);
  (void)edit(2);
  pass(milliseconds(300));
  write_file(call(MethodId::kDraft)["analysis"]["text"].as_string());  // another program writes the same
  clock.advance(DraftFile::kPeriod);
  (void)draft->note();
  pass(milliseconds(300));
  EXPECT_EQ(kept(), 0u);
}

TEST_F(DraftMethodsTest, ADraftThatCannotBeKeptIsAProblemAndIsTriedAgain) {
  std::ofstream(place + "/state") << "no folder";
  (void)edit(1);
  pass(milliseconds(300));
  EXPECT_EQ(draft->note()["problem"].as_string().find("the draft cannot be kept: " + place + "/state/drafts: "), 0u)
      << note();
  EXPECT_EQ(draft->next_due(), clock.now() + DraftMethods::kKeepAgain);
  fs::remove(place + "/state");
  pass(DraftMethods::kKeepAgain);
  EXPECT_EQ(draft->note()["problem"], Json());
  EXPECT_EQ(kept(), 1u);
}

TEST_F(DraftMethodsTest, RefusesATextThatNoFileMayHave) {
  for (const std::string& text : {std::string(300'000, '#'), std::string("a\0b", 3), std::string("\x01")}) {
    EXPECT_EQ(call(MethodId::kReplace, {{"version", 1}, {"text", text}})["kind"], Json("edit"));
    EXPECT_EQ(call(MethodId::kDifferences, {{"text", text}})["kind"], Json("edit"));
  }
  ask(MethodId::kEdit, {{"version", 1}, {"acts", kActs}});
  analyst.next().take(RpcResponse::ready(std::make_shared<const std::string>("{}")), std::string(300'000, '#'));
  EXPECT_EQ(whole(answers.back())["kind"], Json("edit"));
  EXPECT_EQ(draft->note()["version"], Json(1));
}

TEST_F(DraftMethodsTest, PassesRemediesTransitionsAndDifferencesOn) {
  ask(MethodId::kRemedies, {{"version", 1}}, 5);
  ask(MethodId::kDifferences, {{"text", "b: 2\n"}}, 5);
  ask(MethodId::kDifferences, Json::object(), 5);
  ask(MethodId::kTransitions, {{"version", 1}}, 5);
  ASSERT_EQ(analyst.asked.size(), 4u);
  EXPECT_EQ(analyst.asked[0].question.kind, Question::Kind::kOffers);
  EXPECT_EQ(analyst.asked[0].connection, 5u);
  EXPECT_EQ(analyst.asked[1].question.kind, Question::Kind::kDifferences);
  EXPECT_EQ(analyst.asked[1].question.with, "b: 2\n");
  EXPECT_EQ(analyst.asked[2].question.with, "a: 1\n");
  EXPECT_EQ(analyst.asked[3].question.kind, Question::Kind::kModes);
  for (int i = 0; i < 4; ++i) analyst.answer();
  EXPECT_EQ(answers.size(), 4u);
}

TEST_F(DraftMethodsTest, ADraftIsStartedOnlyAsFileHasIt) {
  EXPECT_TRUE(draft->may_start().is_good());
  (void)edit(1);
  EXPECT_EQ(draft->may_start().detail("kind"), "touched");
  (void)call(MethodId::kWrite, {{"version", 2}});
  EXPECT_TRUE(draft->may_start().is_good());
  fs::remove(path);
  EXPECT_EQ(draft->may_start().detail("kind"), "file");
}

}  // namespace
}  // namespace chimera::web
