// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/answer/questions.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>

#include <csignal>

#include "chimera/base/testing/await.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

using control::RpcResponse;

struct QuestionsTest : ::testing::Test {
  void SetUp() override {
    const std::string packed = encode(fake_bundle());
    bundle_ = *FrozenBytes::create("bundle", std::as_bytes(std::span(packed)));
    make(build_path("bin/chimera-manager"));
  }
  void make(const std::string& program) {
    questions_ = std::make_unique<Questions>(program, bundle_.descriptor(),
                                             [this](const std::string& text) { told_ += text + "\n"; });
  }
  void ask(const std::string& name, std::uint64_t connection, const std::string& text = kFakeText) {
    ask(name, connection, {Question::Kind::kCheck, name, text});
  }
  void ask(const std::string& name, std::uint64_t connection, Question question) {
    questions_->ask(
        std::move(question), connection,
        [this, name](const RpcResponse& answer, std::string_view edited) {
          order_ += name + " ";
          answers_[name] = answer;
          edited_[name] = edited;
        },
        now());
  }
  bool until(std::size_t n) {
    return await_that([&] {
      pollfd readable{questions_->descriptor(), POLLIN, 0};
      ::poll(&readable, 1, 5);
      questions_->serve(now());
      return answers_.size() >= n;
    });
  }
  FrozenBytes bundle_;
  std::unique_ptr<Questions> questions_;
  std::map<std::string, RpcResponse> answers_;
  std::map<std::string, std::string> edited_;
  std::string order_, told_;
};

TEST_F(QuestionsTest, AnswersWithTheReportAndEachConnectionInTurn) {
  for (const char* name : {"a1", "a2", "a3"}) ask(name, 1);
  ask("b1", 2, "subsystem: a\ntasks: {sensr: {}}\n");
  ASSERT_TRUE(until(4));
  EXPECT_EQ(order_, "a1 b1 a2 a3 ");
  EXPECT_EQ(Json::parse(*answers_["a3"].text)["legal"], true);
  EXPECT_EQ(Json::parse(*answers_["b1"].text)["legal"], false);
  EXPECT_EQ(told_, "");
}

TEST_F(QuestionsTest, AnswersEachKindWithItsVersion) {
  const std::string acts = R"([{"act": "set", "path": "start", "value": "rest"}])";
  ask("draft", 1, {Question::Kind::kDraft, "a.yaml", kFakeText, acts, UINT64_MAX});
  ask("offers", 1, {Question::Kind::kOffers, "a.yaml", "subsystem: a\ntasks: {sensr: {}}\n", "", 2});
  ask("differ", 1, {Question::Kind::kDifferences, "", "start: a", "start: b", 3});
  ASSERT_TRUE(until(3));
  const Json draft = Json::parse(*answers_["draft"].text);
  EXPECT_EQ(draft["version"].as_uint64(), UINT64_MAX);
  EXPECT_TRUE(edited_["draft"].ends_with("start: rest\n")) << edited_["draft"];
  EXPECT_EQ(draft["text"], edited_["draft"]);
  const Json offers = Json::parse(*answers_["offers"].text);
  EXPECT_EQ(offers["version"], 2);
  EXPECT_EQ(offers["offers"][0]["label"], "write 'sensor'");
  EXPECT_EQ(*answers_["differ"].text, R"({"version":3,"paths":["start"]})");
  EXPECT_EQ(edited_["offers"] + edited_["differ"], "");
}

TEST_F(QuestionsTest, PassesOnARefusalWithItsPlace) {
  ask("bad", 1, {Question::Kind::kDraft, "a.yaml", kFakeText, R"([{"act": "remove", "path": "tasks/lwa"}])", 1});
  ASSERT_TRUE(until(1));
  EXPECT_EQ(answers_["bad"].code, control::kRefused);
  EXPECT_EQ(answers_["bad"].detail("kind"), "edit");
  EXPECT_EQ(answers_["bad"].detail("where"), "tasks/lwa");
  EXPECT_EQ(answers_["bad"].message, "no task 'lwa'; did you mean 'law'?");
  EXPECT_EQ(edited_["bad"], "");
}

TEST_F(QuestionsTest, SendsALargeDraftInPiecesAndItsTextAtOnce) {
  const std::string text = kFakeText + std::string(100'000, '#');
  ask("large", 1, {Question::Kind::kDraft, "a.yaml", text, "", 1});
  ASSERT_TRUE(until(1));
  EXPECT_EQ(edited_["large"], text);
  ASSERT_NE(answers_["large"].pieces, nullptr);
  std::string json;
  while (answers_["large"].pieces->append_to(json)) {}
  EXPECT_EQ(Json::parse(json)["text"], text);
}

TEST_F(QuestionsTest, RefusesTooManyAnalysesAtOnce) {
  for (const char* name : {"1", "2", "3", "4", "5"}) ask(name, 1);
  ASSERT_EQ(answers_.size(), 1u);
  EXPECT_EQ(answers_["5"].code, control::kTooFast);
  EXPECT_EQ(answers_["5"].message, "4 analyses of this connection are under way");
  for (std::uint64_t n = 4; n < kMaxQuestions; ++n) ask("n" + std::to_string(n), n);
  ask("last", 1000);
  EXPECT_EQ(answers_["last"].message, "64 analyses are under way");
}

TEST_F(QuestionsTest, RefusesTooMuchTextInAllAnalyses) {
  const std::string text(kMaxQuestionBytes / 16, '#');
  for (std::uint64_t n = 0; n < 16; ++n) ask("n" + std::to_string(n), n, text);
  ask("last", 1000, "#");
  EXPECT_EQ(answers_["last"].message, "analyses of 16 MiB of text are under way");
}

TEST_F(QuestionsTest, RefusesTooMuchText) {
  const std::string large(std::size_t{1} << 20, '#');
  for (std::uint64_t n = 0; n < 16; ++n) ask("n" + std::to_string(n), n, large);
  EXPECT_EQ(answers_.size(), 0u);
  ask("more", 100, "#");
  EXPECT_EQ(answers_["more"].message, "analyses of 16 MiB of text are under way");
}

TEST_F(QuestionsTest, QuestionsOfAClosedConnectionAreDropped) {
  ask("gone1", 1);
  ask("gone2", 1);
  ask("stays", 2);
  questions_->forget(1);
  EXPECT_EQ(questions_->waiting(), 1u);
  EXPECT_EQ(questions_->analyst(), -1) << "no client waits for the question that it worked at";
  ASSERT_TRUE(until(1));
  EXPECT_EQ(order_, "stays ");
  EXPECT_EQ(told_, "") << "that was no accident";
}

TEST_F(QuestionsTest, ADeathCostsOneQuestion) {
  ask("dies", 1);
  ask("lives", 1);
  ::kill(questions_->analyst(), SIGKILL);  // not reaped yet: still its process id
  ASSERT_TRUE(until(2));
  // It may have answered before it died.
  if (!answers_["dies"].is_good()) {
    EXPECT_EQ(answers_["dies"].message, "the analysis failed: its process ended by signal 9 (SIGKILL)");
  }
  EXPECT_TRUE(answers_["lives"].is_good()) << answers_["lives"].message;
  EXPECT_EQ(told_, "the analyst of descriptions ended by signal 9 (SIGKILL)\n");
}

TEST_F(QuestionsTest, ADeathBetweenTwoQuestionsCostsNone) {
  ask("one", 1);
  ASSERT_TRUE(until(1));
  ::kill(questions_->analyst(), SIGKILL);  // not reaped yet: still its process id
  siginfo_t dead{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(questions_->analyst()), &dead, WEXITED | WNOWAIT), 0);
  ask("two", 1);
  ASSERT_TRUE(until(2));
  EXPECT_TRUE(answers_["two"].is_good()) << answers_["two"].message;
  EXPECT_EQ(told_, "the analyst of descriptions ended by signal 9 (SIGKILL)\n");
}

TEST_F(QuestionsTest, EndsAnAnalysisAtItsTimeLimit) {
  ask("slow", 1);
  ::kill(questions_->analyst(), SIGSTOP);  // not reaped yet: still its process id
  const Nanoseconds late = now() + kAnalysisLimit;
  EXPECT_LE(questions_->next_due(), late);
  questions_->serve(late);
  ASSERT_EQ(answers_.size(), 1u);
  if (!answers_["slow"].is_good()) {
    EXPECT_EQ(answers_["slow"].message, "the analysis was ended: it took longer than 30 s");
  }
}

TEST_F(QuestionsTest, AnIdleAnalystIsEnded) {
  ask("one", 1);
  ASSERT_TRUE(until(1));
  EXPECT_NE(questions_->analyst(), -1);
  questions_->serve(now() + kAnalystIdle - seconds(1));
  EXPECT_NE(questions_->analyst(), -1);
  questions_->serve(now() + kAnalystIdle);
  EXPECT_EQ(questions_->analyst(), -1);
  EXPECT_EQ(questions_->next_due(), kNever);
  EXPECT_EQ(told_, "");
}

TEST_F(QuestionsTest, WithoutAnAnalystAQuestionIsAnswered) {
  make("/nowhere/chimera-manager");
  ask("one", 1);
  ASSERT_EQ(answers_.size(), 1u);
  EXPECT_EQ(answers_["one"].code, control::kRefused);
  EXPECT_NE(answers_["one"].message.find("the analysis could not be started: "), std::string::npos);
}

}  // namespace
}  // namespace chimera::manager
