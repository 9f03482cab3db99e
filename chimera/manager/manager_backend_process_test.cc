// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/manager_backend.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <optional>

#include "chimera/manager/act/operator_acts.h"
#include "chimera/manager/answer/large_readings.h"
#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/answer/value_json.h"
#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/runtime/task_word.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

using control::Role;
using subsystem::RefusalKind;

class ManagerBackendTest : public ::testing::Test {
 protected:
  explicit ManagerBackendTest(const std::string& text = kFakeText) : fake_(text) {}
  void SetUp() override {
    fake_.start_manager();
    ASSERT_TRUE(fake_.until([&] { return fake_.loop().is_ready(); }));
    backend_ = std::make_unique<ManagerBackend>(fake_.loop());
    ASSERT_TRUE(fake_.until([&] { return fake_.n_rtpus() == 0 || (!fake_.told("started").empty() && all_cycle()); }));
  }
  std::uint64_t cycles(std::string_view task) {
    const TaskId id = fake_.task(task);
    return state().peers.of(id).block().profile(id).cycles;
  }
  bool all_cycle() {
    return std::ranges::all_of(fake_.spec().tasks, [this](const TaskSpec& task) { return cycles(task.name) >= 3; });
  }
  control::RpcResponse ask(const char* method, const Json& parameters = Json::object()) {
    std::optional<control::RpcResponse> got;
    backend_->call(*control::find_method(method), parameters, {Role::kConfigure, 1},
                   [&](const control::RpcResponse& answer) { got = answer; });
    EXPECT_TRUE(fake_.until([&] { return got.has_value(); })) << method;
    return got.value_or(control::RpcResponse{});
  }
  Json good(const char* method, const Json& parameters = Json::object()) {
    const control::RpcResponse answer = ask(method, parameters);
    EXPECT_TRUE(answer.is_good()) << method << ": " << answer.message;
    if (answer.is_good() && answer.text != nullptr) return Json::parse(*answer.text);
    return answer.is_good() ? *answer.result : Json();
  }
  /// "CODE MESSAGE DATA" of a refusal.
  std::string refusal(const char* method, const Json& parameters) {
    return text_of(ask(method, parameters));
  }
  /// "CODE MESSAGE DATA" of the answer to a signal that was refused because of the task `law`.
  std::string answer_to(RefusalKind kind, const char* reason, const char* remedy) {
    return text_of(signal_answer(state(), {1, {kind, reason, remedy}, fake_.task("law"), {}}));
  }
  static std::string text_of(const control::RpcResponse& answer) {
    if (answer.is_good()) return "accepted " + answer.result->dump();
    return std::to_string(answer.code) + " " + answer.message + (answer.data ? " " + answer.data->dump() : "");
  }
  ManagerState& state() { return fake_.loop().state(); }

  FakeSubsystem fake_;
  std::unique_ptr<ManagerBackend> backend_;
};

TEST_F(ManagerBackendTest, CarriesOutEveryMethodButThoseOfTheServer) {
  using Kind = control::ParameterKind;
  for (const control::MethodRule& rule : control::methods()) {
    const bool is_of_the_door =
        rule.id == control::MethodId::kSubscribe || rule.id == control::MethodId::kUnsubscribe;
    Json parameters = Json::object();
    for (const control::Parameter& one : rule.parameters)
      if (one.name != nullptr && one.is_required)
        parameters[one.name] = one.kind == Kind::kTexts    ? Json::array()
                               : one.kind == Kind::kObject ? Json::object()
                               : one.kind == Kind::kBool   ? Json(false)
                               : one.kind == Kind::kCount  ? Json(1)
                                                           : Json("off");
    EXPECT_EQ(ask(rule.name, parameters).code == control::kNoMethod, is_of_the_door) << rule.name;
  }
}

TEST_F(ManagerBackendTest, ADrillWithoutHardwareIsNotSafe) {
  EXPECT_EQ(good("drill")["tasks"], Json::array());
  EXPECT_EQ(good("drill")["safe"], false);
}

TEST_F(ManagerBackendTest, ADrillBeginsWithTheFlagDown) {
  good("flag", {{"up", true}});
  EXPECT_EQ(refusal("drill", Json::object()),
            "-32000 the drill is refused: the flag is up already, so it would measure nothing "
            "{\"kind\":\"flag-up\",\"remedy\":\"`chimera status` says by whom\",\"where\":\"\"}");
}

TEST_F(ManagerBackendTest, ADrillKillsNoRtpuThatTheGuardCannotServe) {
  const auto refused = [this] { return refusal("drill", {{"kill", "servo"}}); };
  const auto text = [](const std::string& why, const std::string& remedy) {
    return "-32000 the drill is refused: " + why + " {\"kind\":\"no-guard\",\"remedy\":\"" + remedy +
           "\",\"where\":\"\"}";
  };
  EXPECT_EQ(refused(), text("the subsystem has no guard: no task has a device", "leave out `--kill`"));
  fake_.page().guard_pid = 4711;
  state().guard_hang = "does not run: stopped by a signal (state T), for 1.6 s";
  EXPECT_EQ(refused(), text("the guard does not run: stopped by a signal (state T), for 1.6 s",
                            "`kill -CONT 4711` continues a stopped one"));
  fake_.page().unguarded[0] = EMFILE;
  EXPECT_EQ(refused(), text("no safe frame can be written: Too many open files",
                            "raise the limits of open files (ulimit -n) and locked memory (ulimit -l), and start the "
                            "run again"));
  fake_.page().guard_state = GuardState::kDead;
  EXPECT_EQ(refused(), text("the guard is dead: no safe frames are written until the next run",
                            "end the run and start it again"));
  EXPECT_EQ(fake_.killed, std::nullopt);
  EXPECT_EQ(fake_.told("drill"), "");
}

TEST_F(ManagerBackendTest, NoDrillWhileASwitchIsUnderWay) {
  const Asker ann{control::Role::kOperate, 4'000'000'001u};
  fake_.loop().switches().ask({1, SwitchCause::kScript, {}}, ann, seconds(10), now(),
                                [](const SwitchOutcome&) {});
  EXPECT_EQ(refusal("drill", Json::object()),
            "-32000 the drill is refused: switch 1 to 'rest', asked for by operate:4000000001, is under way "
            "{\"kind\":\"under-way\",\"remedy\":\"ask again when it is over\",\"where\":\"\"}");
}

TEST_F(ManagerBackendTest, HelloNamesProtocolProgramAndSubsystem) {
  const Json hello = good("hello");
  EXPECT_EQ(hello["protocol"], 1);
  EXPECT_EQ(hello["program"], "0.1.0");
  EXPECT_EQ(hello["subsystem"], "fake");
  EXPECT_EQ(hello["role"], "configure");
  EXPECT_EQ(hello["file"], "fake.yaml");
  EXPECT_EQ(hello["keeper_pid"], ::getpid());
  EXPECT_EQ(hello["session"], ::getsid(0));
  EXPECT_EQ(hello["folder"], std::filesystem::current_path().string());
  EXPECT_EQ(hello["manager"]["starts"], 1);
}

TEST_F(ManagerBackendTest, StatusIsReadOutOfTheBlocks) {
  fake_.rtpu(1).block().profile(fake_.task("law")).dropped = 5;
  const Json status = good("status");
  EXPECT_EQ(status["configuration"], "run");
  EXPECT_EQ(status["flag"], (Json{{"up", false}, {"by", Json::array()}}));
  EXPECT_GT(status["started_ns"].as_int64(), status["origin_ns"].as_int64());
  ASSERT_EQ(status["rtpus"].size(), 2u);
  const Json& servo = status["rtpus"][0];
  EXPECT_EQ(servo["name"], "servo");
  EXPECT_EQ(servo["policy"], "edf");
  EXPECT_EQ(servo["phase"], "serving");
  EXPECT_EQ(servo["grant"], "as an ordinary process");
  EXPECT_EQ(servo["running"], nullptr);
  EXPECT_EQ(servo["last_end"], nullptr);
  EXPECT_EQ(servo["alive"], true);
  const Json& law = status["tasks"][2];
  EXPECT_EQ(law["task"], "law");
  EXPECT_EQ(law["rtpu"], "spare");
  EXPECT_EQ(law["state"], "ON");
  EXPECT_EQ(law["rate_hz"], 10.0);
  EXPECT_EQ(law["dropped"], 5);
  EXPECT_EQ(law["execution_ns"], (Json{{"mean", 3000}, {"max", 3000}}));
  EXPECT_EQ(law["fault"], nullptr);
  ASSERT_EQ(law["inputs"].size(), 2u);
  EXPECT_EQ(law["inputs"][0]["port"], "y");
  EXPECT_TRUE(law["inputs"][0]["age_ns"].is_number());
  EXPECT_GT(status_json(state(), {})["tasks"][2]["inputs"][0]["age_ns"].as_int64(), 0) << "0 is of operator variables";
  EXPECT_LT(law["inputs"][0]["age_ns"].as_int64(), 1'000'000'000);
  EXPECT_EQ(law["inputs"][1], (Json{{"port", "kp"}, {"variable", "kp"}, {"age_ns", 0}})) << "never old";
}

TEST_F(ManagerBackendTest, DescribePrintsTheVerifiedApplication) {
  const Json described = good("describe");
  EXPECT_EQ(described["start"], "run");
  EXPECT_EQ(described["configurations"][1], (Json{{"name", "rest"}, {"tasks", {"sensor"}}}));
  const Json& filter = described["tasks"][1];
  EXPECT_EQ(filter["ports"][0], (Json{{"port", "x"}, {"kind", "in-var"}, {"variable", "x"}, {"type", "float64"},
                                      {"unit", "rad"}, {"shape", "[2]"}, {"frame", nullptr}}));
  for (const Json& variable : described["variables"]) {
    if (variable["variable"] != "y") continue;
    EXPECT_EQ(variable["consumers"], (Json::array({Json{{"task", "law"}, {"port", "y"}}})));
  }
}

TEST_F(ManagerBackendTest, AVariableThatIsNamedTwiceIsReadOnce) {
  const auto named = variables_named(state(), {"kp", "x", "kp"});
  EXPECT_EQ(std::get<0>(named), (std::vector{*state().readings->find("kp"), *state().readings->find("x")}));
}

TEST_F(ManagerBackendTest, ReadingsInPiecesAreTheSameAsAtOnce) {
  fake_.rtpu(0).die();  // so that no task writes during the test
  fake_.rtpu(1).die();
  const std::vector<VariableId> variables = std::get<0>(variables_named(state(), {}));
  LargeReadings pieces(state(), variables, R"({"values":)", "}");
  std::string text;
  while (pieces.append_to(text)) {
  }
  Json made = Json::parse(text)["values"], whole = readings_json(state(), variables, now());
  ASSERT_GT(made.size(), 3u);
  for (Json* one : {&made, &whole})
    for (const auto& [name, value] : one->items()) (*one)[name]["age_ns"] = nullptr;
  EXPECT_EQ(made, whole);
}

TEST_F(ManagerBackendTest, NoReadingsInPiecesAreAnEmptyObject) {
  LargeReadings pieces(state(), {}, R"({"values":)", "}");
  std::string text;
  while (pieces.append_to(text)) {
  }
  EXPECT_EQ(Json::parse(text), (Json{{"values", Json::object()}}));
}

TEST_F(ManagerBackendTest, GetReadsTheRegisters) {
  ASSERT_TRUE(fake_.until([&] { return good("get")["values"]["tau"]["sequence"].as_int64() > 2; }));
  const Json values = good("get", {{"variables", {"x", "kp"}}})["values"];
  EXPECT_EQ(values.size(), 2u);
  const Json& x = values["x"];
  EXPECT_EQ(x["value"].size(), 2u);
  EXPECT_EQ(x["unit"], "rad");
  EXPECT_EQ(x["type"], "float64");
  EXPECT_EQ(x["shape"], "[2]");
  EXPECT_EQ(x["producer"], "sensor");
  EXPECT_EQ(x["state"], "ON");
  EXPECT_EQ(x["valid"], true);
  EXPECT_LT(x["age_ns"].as_int64(), 1'000'000'000);
  EXPECT_EQ(values["kp"]["value"], Json::array({1.0, 2.0}));
  EXPECT_EQ(values["kp"]["text"], "[1 2] N.m/rad");
  EXPECT_EQ(values["kp"]["producer"], "operator");
  EXPECT_EQ(refusal("get", {{"variables", {"tua"}}}),
            "-32005 no state variable 'tua'; did you mean 'tau'? {\"nearest\":\"tau\",\"where\":\"tua\"}");
}

TEST_F(ManagerBackendTest, ASignalIsOneTransactionAndReturnsTheStateOfEachTask) {
  EXPECT_EQ(good("signal", {{"signal", "off"}, {"tasks", {"law"}}})["tasks"],
            Json::array({Json{{"task", "law"}, {"before", "ON"}, {"after", "OFF"}}}));
  EXPECT_EQ(good("status")["configuration"], "");
  EXPECT_EQ(refusal("signal", {{"signal", "onn"}, {"tasks", {"law"}}}),
            "-32005 no signal 'onn'; did you mean 'on'? {\"nearest\":\"on\",\"where\":\"onn\"}");
  EXPECT_EQ(refusal("signal", {{"signal", "on"}, {"tasks", {"low"}}}),
            "-32005 no task 'low'; did you mean 'law'? {\"nearest\":\"law\",\"where\":\"low\"}");
  EXPECT_EQ(refusal("signal", {{"signal", "on"}, {"tasks", Json::array()}}),
            "-32602 'tasks' must name at least one {\"where\":\"tasks\"}");
  const std::string refused = refusal("signal", {{"signal", "clear"}, {"tasks", {"law"}}});
  EXPECT_TRUE(refused.starts_with("-32000 ")) << refused;
  EXPECT_NE(refused.find("\"where\":\"law\""), std::string::npos) << refused;
  EXPECT_NE(refused.find("\"kind\":\"state\""), std::string::npos) << refused;
  EXPECT_EQ(good("signal", {{"signal", "off"}, {"tasks", {"law"}}})["tasks"],
            Json::array({Json{{"task", "law"}, {"before", "OFF"}, {"after", "OFF"}, {"already", true}}}));
  EXPECT_EQ(good("signal", {{"signal", "on"}, {"tasks", {"law"}}})["tasks"][0]["after"], "ON");
}

TEST_F(ManagerBackendTest, SetPublishesAndSaveWritesItBackInTheWordsOfADescription) {
  const Json answer = good("set", {{"values", {{"kp", "[100 90] N.m/rad"}}}});
  EXPECT_EQ(answer["values"]["kp"]["value"], Json::array({100.0, 90.0}));
  EXPECT_EQ(good("get", {{"variables", {"kp"}}})["values"]["kp"]["text"], "[100 90] N.m/rad");
  EXPECT_EQ(good("save"), (Json{{"operator", {{"kp", "[100 N.m/rad, 90 N.m/rad]"}}}}));
  EXPECT_EQ(fake_.told("set"), "kp = [100 90] N.m/rad\n");
  EXPECT_TRUE(refusal("set", {{"values", {{"kp", "3 m"}}}}).starts_with("-32602 operator variable 'kp': expected"));
  EXPECT_EQ(refusal("set", {{"values", {{"tau", 3}}}}),
            "-32000 tau is produced by task law, not by the operator {\"kind\":\"not-operator\",\"where\":\"tau\"}");
  EXPECT_EQ(good("get", {{"variables", {"kp"}}})["values"]["kp"]["text"], "[100 90] N.m/rad");
}

TEST_F(ManagerBackendTest, EventsNameWhoCausedThem) {
  const std::uint64_t last = state().log.last();
  (void)good("signal", {{"signal", "off"}, {"tasks", {"law"}}});
  (void)good("set", {{"values", {{"kp", "[3 4] N.m/rad"}}}});
  good("flag", {{"up", true}});
  (void)good("end");
  std::string causes;
  const Json told = good("events", {{"since", last + 1}});
  for (const Json& event : told["events"])
    if (event.contains("by")) causes += event["kind"].as_string() + " " + event["by"].as_string() + "\n";
  EXPECT_EQ(causes, "command configure:root\nset configure:root\nflag configure:root\ncommand configure:root\n");
  EXPECT_EQ(state().acting, "");
}

TEST_F(ManagerBackendTest, AStatusAndWhySayThatAnRtpuIsNotRealTime) {
  std::strcpy(fake_.rtpu(1).block().head().grant,
              "WARNING: not real time\n  memory not locked\n  CPU 1 refused\n  granted: SCHED_FIFO 80");
  EXPECT_EQ(good("status")["rtpus"][0]["not_real_time"], nullptr);
  EXPECT_EQ(good("status")["rtpus"][1]["not_real_time"], "memory not locked; CPU 1 refused");
  fake_.rtpu(1).block().profile(fake_.task("law")).missed = 3;
  EXPECT_EQ(good("why", {{"variable", "tau"}})["chain"][0]["timing"],
            "3 missed, spare is not real time: memory not locked; CPU 1 refused");
}

TEST_F(ManagerBackendTest, TheOperatorsFlagStaysUntilItIsLowered) {
  EXPECT_EQ(good("flag", {{"up", true}}), (Json{{"up", true}, {"by", {"operator"}}}));
  EXPECT_EQ(good("status")["flag"], (Json{{"up", true}, {"by", {"operator"}}}));
  EXPECT_EQ(state().own.block().head().flag, 4u);
  EXPECT_EQ(good("flag", {{"up", false}}), (Json{{"up", false}, {"by", Json::array()}}));
  EXPECT_EQ(good("status")["flag"]["up"], false);
  EXPECT_EQ(fake_.told("flag"), "the operator raised the flag\nthe operator lowered the flag\n");
}

TEST_F(ManagerBackendTest, WhyFindsTheProducerThatIsOff) {
  const std::string before = good("why", {{"variable", "tau"}})["verdict"].as_string();
  EXPECT_TRUE(before.starts_with("tau is good: law wrote it")) << before;
  (void)good("signal", {{"signal", "off"}, {"tasks", {"sensor"}}});
  const Json why = good("why", {{"variable", "tau"}});
  EXPECT_EQ(why["verdict"], "tau depends on x: its producer sensor is OFF");
  EXPECT_EQ(why["chain"][0]["variable"], "tau");
  EXPECT_EQ(why["chain"][why["chain"].size() - 1]["verdict"], "producer-off");
}

TEST_F(ManagerBackendTest, WhySeesADeadRtpu) {
  fake_.kill_rtpu(0, SIGKILL);
  ASSERT_TRUE(fake_.until([&] { return !state().rtpus[0].is_alive; }));
  const std::string verdict = good("why", {{"variable", "x"}})["verdict"].as_string();
  EXPECT_TRUE(verdict.starts_with("x: the rtpu servo of its producer sensor is dead: ")) << verdict;
}

TEST_F(ManagerBackendTest, ProfileIsThatOfEveryOtherFace) {
  const Json profile = good("profile");
  ASSERT_EQ(profile["tasks"].size(), 3u);
  EXPECT_EQ(profile["tasks"][0]["task"], "sensor");
  EXPECT_GT(profile["tasks"][0]["execution_ns"]["cycle"]["count"].as_int64(), 0);
}

TEST_F(ManagerBackendTest, TheTapIsReadAgainOnlyWhenAllThatWasReadIsTaken) {
  ASSERT_TRUE(backend_->open(1, {{"to", "tap"}}).is_good());  // two rtpus: each reading gives two messages
  std::vector<Nanoseconds> pulled;
  for (std::int64_t last = 0; pulled.size() < 8;) {
    const std::uint64_t sensor = cycles("sensor"), law = cycles("law");
    ASSERT_TRUE(fake_.until([&] { return cycles("sensor") > sensor + 1 && cycles("law") > law + 1; }));
    pulled.push_back(now());
    const auto news = backend_->pull(1);
    ASSERT_NE(news, nullptr);
    const Json& records = news->at("records");
    last = records[records.size() - 1][0].as_int64();
    if (pulled.size() < 3) continue;
    EXPECT_GT(last, pulled[pulled.size() - 3].count) << "the age of the records does not grow";
  }
}

TEST_F(ManagerBackendTest, ChecksATextWithTheLibraryOfTheStart) {
  EXPECT_EQ(good("check", {{"text", kFakeText}, {"file", "mine.yaml"}})["legal"], true);
  const Json report = good("check", {{"text", "subsystem: a\ntasks: {sensr: {}}\n"}, {"file", "mine.yaml"}});
  EXPECT_EQ(report["legal"], false);
  EXPECT_EQ(report["faults"][0]["file"], "mine.yaml");
  EXPECT_EQ(report["faults"][0]["nearest"], "sensor");
}

TEST_F(ManagerBackendTest, AnalysesATextWithTheLibraryOfTheStart) {
  const Json analysis = good("schedule", {{"text", kFakeText}, {"file", "mine.yaml"}});
  EXPECT_EQ(analysis["fits"], true);
  EXPECT_FALSE(analysis["sets"][0]["cpus"].empty());
  EXPECT_EQ(good("schedule", {{"text", "subsystem: a\ntasks: {sensr: {}}\n"}})["legal"], false);
}

TEST_F(ManagerBackendTest, ARefusedSignalHasKindPlaceAndRemedy) {
  EXPECT_EQ(answer_to(RefusalKind::kState, "no answer from a parser", "type `chimera clear law`"),
            "-32000 no answer from a parser; type `chimera clear law` "
            R"({"kind":"state","remedy":"type `chimera clear law`","where":"law"})");
  EXPECT_EQ(answer_to(RefusalKind::kFault, "the smallest legal set is: empty", ""),
            R"(-32000 the smallest legal set is: empty {"kind":"fault","where":"law"})");
}

TEST_F(ManagerBackendTest, OnOfTheTasksOfARefusedSetIsAccepted) {
  (void)good("signal", {{"signal", "off"}, {"tasks", {"law", "sensor"}}});
  const control::RpcResponse refused = ask("signal", {{"signal", "on"}, {"tasks", {"law"}}});
  ASSERT_FALSE(refused.is_good());
  EXPECT_EQ(refused.detail("kind"), "set") << text_of(refused);
  const Json tasks = (*refused.data)["tasks"];
  EXPECT_GE(tasks.size(), 2u) << text_of(refused);
  EXPECT_EQ(good("signal", {{"signal", "on"}, {"tasks", tasks}})["tasks"].size(), tasks.size());
}

TEST_F(ManagerBackendTest, AnswersForAnRtpuThatIsSilentWithItsName) {
  EXPECT_EQ(answer_to(RefusalKind::kNoAnswer, "silence", ""),
            R"(-32006 silence {"rtpu":"spare","running":null})");
}

TEST_F(ManagerBackendTest, AnswersASignalWithTheStatesOfEachTask) {
  const subsystem::CommandAnswer done{1, {}, TaskId{}, {{fake_.task("law"), State::kOn, State::kOff, false},
                                                        {fake_.task("filter"), State::kOff, State::kOff, true}}};
  const control::RpcResponse answer = signal_answer(state(), done);
  ASSERT_TRUE(answer.is_good());
  EXPECT_EQ((*answer.result)["tasks"],
            Json::array({Json{{"task", "law"}, {"before", "ON"}, {"after", "OFF"}},
                         Json{{"task", "filter"}, {"before", "OFF"}, {"after", "OFF"}, {"already", true}}}));
}

class ServedTest : public ManagerBackendTest {
 protected:
  ServedTest() : ManagerBackendTest(kServedText) {}
};

TEST_F(ServedTest, RingsReachTheRtpuAsOftenAsTheTaskIsNamed) {
  EXPECT_EQ(good("ring", {{"tasks", {"lamp"}}}), (Json{{"tasks", {"lamp"}}}));
  EXPECT_EQ(good("ring", {{"tasks", {"lamp", "lamp"}}})["tasks"].size(), 2u);
  ASSERT_TRUE(fake_.until([&] { return fake_.rtpu(0).rings == 3; }));
  EXPECT_EQ(fake_.told("command"), "ring lamp: done\nring lamp, lamp: done\n");
}

TEST_F(ServedTest, StatusHasTheServerAndTheTimeSinceOn) {
  const Nanoseconds since = now() - seconds(2);
  fake_.rtpu(0).block().profile(fake_.task("lamp")).on_since = since;
  const Json lamp = good("status")["tasks"][1], sensor = good("status")["tasks"][0];
  const Json server = {{"kind", "deferrable"}, {"capacity_ns", 2000000}, {"period_ns", 10000000}};
  EXPECT_EQ(lamp["server"], server);
  EXPECT_EQ(lamp["has_doorbell"], true);
  EXPECT_GE(lamp["on_ns"].as_int64(), 2'000'000'000);
  EXPECT_LT(lamp["on_ns"].as_int64(), 20'000'000'000);
  EXPECT_GE(lamp["busy_ns"].as_int64(), 3 * 3000) << "of the fake: 3 us a cycle";
  EXPECT_EQ(sensor["server"], nullptr);
  EXPECT_EQ(sensor["has_doorbell"], false);
  const Json profile = good("profile")["tasks"][1];
  EXPECT_EQ(profile["server"], server);
  EXPECT_GE(profile["on_ns"].as_int64(), 2'000'000'000);
  (void)good("signal", {{"signal", "off"}, {"tasks", {"lamp"}}});
  EXPECT_EQ(good("status")["tasks"][1]["on_ns"], 0) << "its time of `on` is unknown";
}

TEST_F(ServedTest, RefusesARingForATaskThatCannotAnswer) {
  EXPECT_EQ(refusal("ring", {{"tasks", {"lamp", "sensor"}}}),
            "-32000 sensor has no doorbell: neither a server nor events release it "
            "{\"kind\":\"no-server\",\"remedy\":\"give it 'server:' in the description\",\"where\":\"sensor\"}");
  EXPECT_EQ(refusal("ring", {{"tasks", {"lmp"}}}),
            "-32005 no task 'lmp'; did you mean 'lamp'? {\"nearest\":\"lamp\",\"where\":\"lmp\"}");
  EXPECT_EQ(refusal("ring", {{"tasks", Json::array()}}), "-32602 'tasks' must name at least one {\"where\":\"tasks\"}");
  (void)good("signal", {{"signal", "off"}, {"tasks", {"lamp"}}});
  EXPECT_EQ(refusal("ring", {{"tasks", {"lamp"}}}),
            "-32000 lamp is OFF: no job would answer the event "
            "{\"kind\":\"state\",\"remedy\":\"turn it ON first\",\"where\":\"lamp\"}");
  EXPECT_EQ(fake_.rtpu(0).rings, 0);
  fake_.page().ending = 1;
  EXPECT_EQ(refusal("ring", {{"tasks", {"lamp"}}}), "-32007 the subsystem is ending");
}

TEST_F(ServedTest, MoreRingsThanAnRtpuTakesAreRefusedAsAWhole) {
  fake_.rtpu(0).is_deaf = true;
  const Json many = {{"tasks", std::vector<std::string>(kPosts, "lamp")}};
  (void)good("ring", {{"tasks", {"lamp"}}});
  EXPECT_EQ(refusal("ring", many), "-32006 no answer from rtpu servo {\"rtpu\":\"servo\",\"running\":null}");
  fake_.rtpu(0).is_deaf = false;
  ASSERT_TRUE(fake_.until([&] { return fake_.rtpu(0).rings == 1; }));
}

class IdleTest : public ManagerBackendTest {
 protected:
  IdleTest() : ManagerBackendTest("") {}
};

TEST_F(IdleTest, ServesEditors) {
  EXPECT_EQ(good("hello")["file"], "");
  EXPECT_EQ(good("check", {{"text", kFakeText}})["legal"], true);
  EXPECT_EQ(good("schedule", {{"text", kFakeText}})["fits"], true);
  EXPECT_EQ(good("library")["components"].size(), 7u);
  EXPECT_EQ(good("status")["tasks"], Json::array());
  EXPECT_EQ(good("describe")["tasks"], Json::array());
  EXPECT_EQ(good("get")["values"], Json::object());
  EXPECT_EQ(good("save")["operator"], Json::object());
  EXPECT_EQ(refusal("why", {{"variable", "x"}}), "-32005 no state variable 'x' {\"where\":\"x\"}");
  EXPECT_EQ(refusal("signal", {{"signal", "on"}, {"tasks", {"x"}}}), "-32005 no task 'x' {\"where\":\"x\"}");
  EXPECT_EQ(good("profile")["tasks"], Json::array());
}

}  // namespace
}  // namespace chimera::manager
