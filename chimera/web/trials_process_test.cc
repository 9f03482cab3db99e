// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/trials.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "chimera/base/testing/await.h"
#include "chimera/control/methods.h"
#include "chimera/platform/process_state.h"
#include "chimera/text/json.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;
using control::MethodId;
using control::RpcResponse;

/// Answers `draft` with one outline.
struct OneOutline final : Analyst {
  std::uint64_t library() override { return 1; }
  void ask(manager::Question question, std::uint64_t, Take take) override {
    const Json analysis{{"version", question.version}, {"text", question.text}, {"outline", outline}};
    take(RpcResponse::ready(std::make_shared<const std::string>(analysis.dump())), question.text);
  }
  Json outline = Json::object();
};

/// A script in the place of `chimera`.
struct TrialsTest : ::testing::Test {
  TrialsTest() : place(::mkdtemp(made)), file(place + "/arm.yaml") {
    std::ofstream(file) << "subsystem: arm\n";
    fs::create_directories(place + "/build/components");
    draft.emplace(file, place + "/state/drafts", analyst, clock, [](const std::string&) {});
  }
  ~TrialsTest() override {
    trials.reset();
    fs::remove_all(place);
  }
  /// `text` finds its words in $@, and the folder of the trial in $folder.
  void script(const std::string& text) {
    std::ofstream(place + "/chimera") << "#!/bin/sh\nfor w in \"$@\"; do case \"$w\" in --csv=*) folder=${w#--csv=}; "
                                         "folder=${folder%/csv};; esac; done\n"
                                      << text;
    fs::permissions(place + "/chimera", fs::perms::owner_all);
    trials.emplace(place + "/chimera", place + "/state/trials", file, clock);
  }
  RpcResponse call(MethodId method, const Json& parameters, std::uint64_t connection = 1) {
    RpcResponse answer;
    const control::MethodRule& rule = control::methods()[static_cast<std::size_t>(method)];
    const RpcResponse judged = control::check_parameters(rule, parameters);
    if (!judged.is_good()) return judged;
    trials->call(
        method, parameters, {control::Role::kConfigure, connection, 0},
        [&](const RpcResponse& given) { answer = given; }, &*draft);
    return answer;
  }
  RpcResponse try_it(const Json& more = Json::object(), std::uint64_t connection = 1) {
    Json parameters{{"version", 1}, {"duration", "2 s"}, {"watch", Json::array({"q"})}};
    for (const auto& [key, value] : more.items()) parameters[key] = value;
    return call(MethodId::kTry, parameters, connection);
  }
  Json result(std::uint64_t number) { return Json::parse(*call(MethodId::kResult, {{"number", number}}).text); }
  Json ended(std::uint64_t number) {
    EXPECT_TRUE(await_that([&] { return trials->serve(), !result(number)["ended"].is_null(); }));
    return result(number);
  }
  std::string trial_folder(std::uint64_t number) const {
    return place + "/state/trials/" + std::to_string(own_process_id()) + "/" + std::to_string(number);
  }

  char made[40] = "/tmp/chimera_trial_XXXXXX";
  std::string place, file;
  VirtualClock clock;
  OneOutline analyst;
  std::optional<DraftMethods> draft;
  std::optional<Trials> trials;
};

Json outline_of(const char* port) {
  return Json::parse(std::string(R"({"tasks":[{"task":"arm","period_ns":1000000,"aperiodic":false,"ports":[)") + port +
                     "]}]}");
}

TEST_F(TrialsTest, RunsACopyOfTheDraftBesideTheComponentsOfFile) {
  analyst.outline = outline_of("");
  script(
      "printf '%s\\n' \"$@\" >&2; cat \"$2\"; "
      "ls -d \"$(dirname \"$2\")/build/components\" >&2; echo table > $folder/csv\n");
  const Json acts = Json::array({"1 s: set kp 1", "-x"});
  const RpcResponse started = try_it({{"at", acts}, {"expect", Json::array({"|u| <= 1"})}});
  ASSERT_TRUE(started.is_good()) << started.message;
  EXPECT_EQ(started.result->dump(), R"({"number":1})");
  const Json done = ended(1);
  EXPECT_EQ(done["ended"].dump(), R"({"code":0})");
  EXPECT_TRUE(done["why"].is_null());
  EXPECT_EQ(done["output"], Json("subsystem: arm\n"));
  EXPECT_EQ(done["csv"], Json("table\n"));
  EXPECT_TRUE(done["svg"].is_null());
  const std::string folder = trial_folder(1);
  EXPECT_EQ(done["error"], Json("run\n" + file + "\n--csv=" + folder +
                                "/csv\n--virtual\n--json\n--for=2 s\n--watch=q\n--at=1 s: set kp 1\n--at=-x\n"
                                "--expect=|u| <= 1\n--every=1000000 ns\n" +
                                folder + "/text/build/components\n"));
}

TEST_F(TrialsTest, TakesAtMost2000SamplesUnlessTheyAreAskedFor) {
  analyst.outline = outline_of("");
  script("for w in \"$@\"; do case \"$w\" in --every=*) echo \"$w\";; esac; done\n");
  const std::pair<const char*, const char*> cases[] = {
      {"2 s", "1000000"}, {"2.1 s", "2000000"}, {"10 s", "5000000"}, {"0 s", "1000000"}, {"1 h", "1800000000"}};
  std::uint64_t number = 0;
  for (const auto& [duration, every] : cases) {
    ASSERT_TRUE(try_it({{"duration", duration}}).is_good());
    EXPECT_EQ(ended(++number)["output"], Json("--every=" + std::string(every) + " ns\n")) << duration;
  }
  ASSERT_TRUE(try_it({{"every", "3 ms"}}).is_good());
  EXPECT_EQ(ended(++number)["output"], Json("--every=3 ms\n"));
}

TEST_F(TrialsTest, AsksBeforeItOpensWhatTasksMayNotShare) {
  script("echo ran\n");
  analyst.outline = outline_of(R"({"port":"bus","kind":"resource","shared":false,"value":"'/dev/ttyS0'"},)"
                               R"({"port":"model","kind":"resource","shared":true,"value":"a.xml"})");
  const RpcResponse asked = try_it();
  EXPECT_EQ(asked.detail("kind"), "devices");
  EXPECT_EQ(asked.message, "the try opens what the resources name: arm.bus /dev/ttyS0");
  EXPECT_EQ((*asked.data)["resources"].dump(), R"([{"port":"bus","task":"arm","text":"/dev/ttyS0"}])");
  EXPECT_EQ(try_it({{"devices", false}}).detail("kind"), "devices");
  EXPECT_TRUE(try_it({{"devices", true}}).is_good());
  EXPECT_EQ(ended(1)["output"], Json("ran\n"));
}

TEST_F(TrialsTest, RefusesADraftThatIsNoDescriptionAndAnOldVersion) {
  script("echo ran\n");
  EXPECT_EQ(try_it({{"version", 2}}).detail("kind"), "stale");
  analyst.outline = nullptr;
  EXPECT_EQ(try_it().detail("kind"), "draft");
  EXPECT_FALSE(fs::exists(place + "/state/trials"));
}

TEST_F(TrialsTest, RecordsWithTheWordsOfScopeAndNoChannelIsAnOption) {
  script("shift; shift; for w in \"$@\"; do case \"$w\" in --csv=*) ;; *) echo \"$w\";; esac; done\n");
  ASSERT_TRUE(call(MethodId::kScope, {{"machine", "arm"},
                                      {"channels", Json::array({"--csv", "q[2]"})},
                                      {"trigger", "-q > 1"},
                                      {"pre", "5 ms"},
                                      {"for", "1 s"},
                                      {"wait", "2 s"}})
                  .is_good());
  EXPECT_EQ(ended(1)["output"],
            Json("--json\n--subsystem=arm\n--trigger=-q > 1\n--pre=5 ms\n--for=1 s\n--wait=2 s\n--\n--csv\nq[2]\n"));
}

TEST_F(TrialsTest, RefusesTextsThatAreNoWordsOfACommand) {
  script("touch \"$0.ran\"\n");
  const std::string zero("a\0b", 3), large(1 << 20, 'x');
  const Json scope{{"machine", "arm"}, {"channels", Json::array({"q"})}};
  for (const std::string& word : {std::string(), zero, large}) {
    for (const char* key : {"duration", "every"}) EXPECT_EQ(try_it({{key, word}}).code, control::kBadParameters) << key;
    for (const char* key : {"watch", "at", "expect"})
      EXPECT_EQ(try_it({{key, Json::array({word})}}).code, control::kBadParameters) << key;
    for (const char* key : {"machine", "trigger", "pre", "for", "wait"}) {
      Json parameters = scope;
      parameters[std::string_view(key)] = word;
      EXPECT_EQ(call(MethodId::kScope, parameters).code, control::kBadParameters) << key;
    }
  }
  const Json many(std::vector<std::string>(33, "q"));
  for (const char* key : {"watch", "at", "expect"}) EXPECT_EQ(try_it({{key, many}}).detail("where"), key);
  EXPECT_EQ(try_it({{"watch", Json::array()}}).message, "'watch' must have 1 to 32 texts");
  const Json elsewhere{{"machine", "../arm"}, {"channels", Json::array({"q"})}};
  EXPECT_EQ(call(MethodId::kScope, elsewhere).detail("where"), "machine");
  EXPECT_EQ(try_it({{"duration", "--json"}}).detail("where"), "duration");
  EXPECT_EQ(call(MethodId::kResult, {{"number", 1}}).code, control::kUnknown);
  EXPECT_EQ(call(MethodId::kHalt, {{"number", 1}}).code, control::kUnknown);
  EXPECT_FALSE(fs::exists(place + "/chimera.ran"));
}

TEST_F(TrialsTest, HaltsWithAnInterruptAndKillsWhatGoesOn) {
  script(
      "trap 'echo asked; test $1 = scope && exit 3' INT\necho began; touch $folder/began\n"
      "while true; do sleep 0.01; done\n");
  ASSERT_TRUE(call(MethodId::kScope, {{"machine", "arm"}, {"channels", Json::array({"q"})}}).is_good());
  ASSERT_TRUE(try_it({{"devices", true}}).is_good());
  for (const std::uint64_t number : {1u, 2u})
    ASSERT_TRUE(await_that([&] { return fs::exists(trial_folder(number) + "/began"); }));
  EXPECT_TRUE(result(1)["ended"].is_null());
  EXPECT_TRUE(call(MethodId::kHalt, {{"number", 1}}).is_good());
  const Json first = ended(1);
  EXPECT_EQ(first["ended"].dump(), R"({"code":3})");
  EXPECT_EQ(first["why"], Json("halted"));
  EXPECT_EQ(first["output"], Json("began\nasked\n"));

  clock.advance(Trials::kTryLimit - Nanoseconds{1});
  trials->serve();
  EXPECT_TRUE(result(2)["why"].is_null());
  EXPECT_EQ(trials->next_due(), clock.now() + Nanoseconds{1});
  clock.advance(Nanoseconds{1});
  trials->serve();
  EXPECT_EQ(result(2)["why"], Json("its 60 s are over"));
  clock.advance(Trials::kEndLimit);
  const Json second = ended(2);
  EXPECT_EQ(second["ended"].dump(), R"x({"signal":"signal 9 (SIGKILL)"})x");
  EXPECT_EQ(second["why"], Json("its 60 s are over"));
  EXPECT_EQ(trials->next_due(), kNever);
}

TEST_F(TrialsTest, RunsFourAtATimeAndKeepsTheLastTen) {
  script("while [ ! -e $folder/go ]; do sleep 0.01; done\n");
  analyst.outline = outline_of("");
  for (int i = 1; i <= 4; ++i) ASSERT_TRUE(try_it().is_good());
  EXPECT_EQ(try_it().detail("kind"), "under-way");
  for (std::uint64_t number = 1; number <= 11; ++number) {
    std::ofstream(trial_folder(number) + "/go") << "";
    (void)ended(number);
    if (number <= 9) {
      ASSERT_TRUE(try_it().is_good()) << number;
    }
  }
  EXPECT_FALSE(fs::exists(trial_folder(1)));
  EXPECT_FALSE(fs::exists(trial_folder(3)));
  EXPECT_TRUE(fs::exists(trial_folder(4)));
  EXPECT_EQ(call(MethodId::kResult, {{"number", 3}}).message, "there is no trial 3: the last 10 are kept");
}

TEST_F(TrialsTest, HaltsWhatAPageAskedForWhenThePageIsGone) {
  script("trap 'exit 0' INT; touch $folder/began; while true; do sleep 0.01; done\n");
  analyst.outline = outline_of("");
  ASSERT_TRUE(try_it({}, 7).is_good());
  ASSERT_TRUE(await_that([&] { return fs::exists(trial_folder(1) + "/began"); }));
  trials->forget(8);
  EXPECT_TRUE(result(1)["why"].is_null());
  trials->forget(7);
  EXPECT_EQ(ended(1)["why"], Json("its page is gone"));
}

TEST_F(TrialsTest, BoundsFilesAndLeavesNothingBehind) {
  script("head -c 17000000 /dev/zero > $folder/csv || echo \"$?\"; while true; do sleep 0.01; done\n");
  analyst.outline = outline_of("");
  fs::create_directories(place + "/state/trials/999999999/1");  // of a process that was killed
  ASSERT_TRUE(try_it().is_good());
  const std::string output = trial_folder(1) + "/output";
  ASSERT_TRUE(await_that([&] { return fs::exists(output) && fs::file_size(output) > 0; }));
  EXPECT_EQ(fs::file_size(trial_folder(1) + "/csv"), Trials::kMostBytes);
  EXPECT_EQ(static_cast<unsigned>(fs::status(place + "/state/trials").permissions()), 0700u);
  EXPECT_FALSE(fs::exists(place + "/state/trials/999999999"));
  EXPECT_TRUE(call(MethodId::kHalt, {{"number", 1}}).is_good());
  EXPECT_TRUE(ended(1)["csv"].is_null());
  trials->finish();
  EXPECT_TRUE(fs::is_empty(place + "/state/trials"));
}

}  // namespace
}  // namespace chimera::web
