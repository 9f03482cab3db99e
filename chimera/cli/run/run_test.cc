// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/run.h"

#include "chimera/cli/run/profile_report.h"
#include "chimera/cli/run/testing/test_application.h"

namespace chimera::cli {
namespace {

/// Keeps every record as text.
class Records final : public RecordSink {
 public:
  void begin(const ApplicationSpec&, Nanoseconds origin, Nanoseconds) override { origin_ = origin; }
  void on_records(std::span<const TapRecord> records) override {
    for (const TapRecord& r : records)
      text += std::to_string((r.at - origin_).count) + " " + std::to_string(static_cast<int>(r.kind)) + " " +
              std::to_string(r.a) + " " + std::to_string(r.b) + "\n";
  }
  void end(std::uint64_t dropped, std::uint64_t) override { lost = dropped; }

  std::string text;
  std::uint64_t lost = 99;

 private:
  Nanoseconds origin_;
};

struct Said {
  int code = -1;
  std::string out, err;
};

std::string taken(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
  std::fclose(file);
  return text;
}

Said said_by(RunRequest request, const std::string& text, RecordSink* sink = nullptr) {
  const TestFile file(text);
  request.file = file.path();
  request.virtual_time = true;
  std::FILE* out = std::tmpfile();
  std::FILE* err = std::tmpfile();
  Said said;
  said.code = run(request, test_place(), sink, out, err);
  said.out = taken(out);
  said.err = taken(err);
  return said;
}

constexpr const char* kDrawn = R"(subsystem: drawn
tasks:
  counter: {component: t_counter, min: 50 us, budget: 500 us}
)";

RunRequest lasting(Nanoseconds duration) {
  RunRequest request;
  request.duration = duration;
  return request;
}

TEST(Run, CountsOneCycleForEachPeriod) {
  RunRequest request = lasting(milliseconds(10));
  request.expect = {"count >= 10", "dt <= 1 ms"};
  const Said said = said_by(request, kCounterText);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_NE(said.out.find("holds: count >= 10 (count is 10)\n"), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("ran 0.010 s\n"), std::string::npos) << said.out;
  EXPECT_EQ(said.err, "");  // no progress: `err` is no terminal
}

constexpr const char* kLate = R"(subsystem: late
tasks:
  a: {component: t_source, rate: 100 Hz, deadline: 4 ms, alias: {x: xa, expired: ea}, constants: {spend: 1000000 ns}}
  b: {component: t_source, rate: 100 Hz, deadline: 5 ms, min: 4500 us, on_miss: REACTION, alias: {x: xb, expired: eb},
      constants: {spend: 6000000 ns}}
)";

std::string late(const std::string& reaction) {
  std::string text = kLate;
  return text.replace(text.find("REACTION"), 8, reaction);
}

TEST(Run, ReportsTheFlagAndTheTaskWithoutTime) {
  RunRequest request = lasting(milliseconds(30));
  const Said said = said_by(request, late("flag"));
  EXPECT_NE(said.out.find("ran 0.030 s\nthe illegal-configuration flag is up\n"), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("\nb: 3 without time for 'min'\n"), std::string::npos) << said.out;
  request.json = true;
  EXPECT_NE(said_by(request, late("flag")).out.find("\"flag\": true"), std::string::npos);
  EXPECT_NE(said_by(request, late("continue")).out.find("\"flag\": false"), std::string::npos);
}

TEST(Run, NamesTheTaskWhoseReactionStoppedIt) {
  const Said said = said_by(lasting(milliseconds(30)), late("stop"));
  EXPECT_EQ(said.code, kRefused);
  EXPECT_NE(said.out.find(", ended by the reaction `stop` of task 'b'\n"), std::string::npos) << said.out;
}

TEST(Run, AnExpectationThatFailsIsNoSuccess) {
  RunRequest request = lasting(milliseconds(10));
  request.expect = {"count < 10"};
  const Said said = said_by(request, kCounterText);
  EXPECT_EQ(said.code, kRefused);
  EXPECT_NE(said.out.find("FAILS: count < 10 (count is 10)\n"), std::string::npos) << said.out;
}

TEST(Run, JudgesMeasuresOfTheWholeRunInVirtualTime) {
  RunRequest request = lasting(milliseconds(10));
  request.expect = {"max count <= 10", "mean |count| < 6", "settling count >= 5 within 6 ms", "count <= 10"};
  const Said said = said_by(request, kCounterText);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_NE(said.out.find("holds: max count <= 10 (max count is 10)\n"), std::string::npos) << said.out;
  request.expect = {"max count <= 9"};
  EXPECT_EQ(said_by(request, kCounterText).code, kRefused);
  request.expect = {"maximum count <= 9"};
  const std::string wrong = "--expect 'maximum count <= 9': no measure 'maximum'";
  EXPECT_NE(said_by(request, kCounterText).err.find(wrong), std::string::npos);
}

TEST(Run, TheSameSeedGivesTheSameBytes) {
  RunRequest request = lasting(milliseconds(50));
  request.seed = 7;
  request.json = true;
  Records first, second, other;
  const Said once = said_by(request, kDrawn, &first);
  const Said again = said_by(request, kDrawn, &second);
  EXPECT_EQ(once.code, kOk) << once.out;
  EXPECT_EQ(once.out, again.out);
  EXPECT_EQ(first.text, second.text);
  EXPECT_EQ(first.lost, 0u);
  EXPECT_GT(first.text.size(), 1000u);
  request.seed = 8;
  EXPECT_NE(said_by(request, kDrawn, &other).out, once.out);
  EXPECT_NE(other.text, first.text);
}

TEST(Run, NamesAreJudgedBeforeAnythingRuns) {
  RunRequest request = lasting(milliseconds(10));
  request.watch = {"cont"};
  const Said watched = said_by(request, kCounterText);
  EXPECT_EQ(watched.code, kUsage);
  EXPECT_NE(watched.err.find("error: no state variable 'cont'; did you mean 'count'?\n"), std::string::npos);
  request.watch.clear();
  request.at = {"1 ms: offf counter"};
  EXPECT_EQ(said_by(request, kCounterText).err,
            "error: --at '1 ms: offf counter': no signal 'offf'; did you mean 'off'?\n");
}

TEST(Run, EndsWhenNoTaskIsOnAnyMore) {
  RunRequest request = lasting(seconds(10));
  request.at = {"5 ms: off counter"};
  request.json = true;
  const Said said = said_by(request, kCounterText);
  EXPECT_NE(said.out.find("\"ended\": \"nothing-left\""), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("\"state\": \"OFF\""), std::string::npos) << said.out;
}

TEST(Run, WatchesAtTheStatedDistance) {
  RunRequest request = lasting(milliseconds(30));
  request.watch = {"count"};
  request.every = milliseconds(10);
  const Said said = said_by(request, kCounterText);
  EXPECT_NE(said.out.find("t 0.010 s  count 10\nt 0.020 s  count 20\nt 0.030 s  count 30\n"), std::string::npos)
      << said.out;
}

constexpr const char* kGain = R"(subsystem: small
constants: {k: 2 N.m/rad}
tasks:
  gain: {rate: 100 Hz}
operator: {x: 1 rad}
)";

TEST(Run, AValueGivenBesideTheFileTakesTheRoomOfItsOwn) {
  RunRequest request = lasting(milliseconds(20));
  request.expect = {"y >= 1500 N.m", "y <= 1500 N.m"};
  EXPECT_EQ(said_by(request, kGain).code, kRefused);
  request.settings = {{"x", "300 rad", "--set x '300 rad'"}, {"k", "5 N.m/rad", "--set k '5 N.m/rad'"}};
  const Said said = said_by(request, kGain);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  request.settings = {{"xx", "1 rad", "--set xx '1 rad'"}};
  EXPECT_NE(said_by(request, kGain).err.find("--set xx '1 rad': the file has no operator variable or constant 'xx'; "
                                             "did you mean 'x'?\n"),
            std::string::npos);
}

TEST(Run, AValueSetAtATimeCountsFromTheNextJobOn) {
  RunRequest request = lasting(milliseconds(40));
  request.watch = {"y"};
  request.every = milliseconds(10);
  request.at = {"15 ms: set x 180 deg", "30 ms: set x -1 rad"};
  const Said said = said_by(request, kGain);
  EXPECT_NE(said.out.find("t 0.010 s  y 2 N.m\nt 0.020 s  y 2 N.m\n"
                          "t 0.030 s  y 6.28319 N.m\nt 0.040 s  y -2 N.m\n"),
            std::string::npos)
      << said.out << said.err;
  EXPECT_EQ(said_by(request, kGain).out, said.out) << "each run gives equal bytes";
  request.preemptive = true;
  EXPECT_NE(said_by(request, kGain).out.find(
                "t 0.030 s  y 6.28319 N.m\nt 0.040 s  y -2 N.m\n"), std::string::npos);
}

TEST(Run, ShowsAValueInTheUnitOfTheFile) {
  const std::string gain = kGain;
  RunRequest request = lasting(milliseconds(20));
  request.watch = {"x"};
  request.every = milliseconds(20);
  request.expect = {"x <= 2 rad"};
  const std::string text = std::string(gain).replace(gain.find("1 rad"), 5, "90 deg");
  const Said said = said_by(request, text);
  EXPECT_NE(said.out.find("t 0.020 s  x 90 deg\n"), std::string::npos) << said.out << said.err;
  EXPECT_NE(said.out.find("holds: x <= 2 rad (x is 1.5708 rad)\n"), std::string::npos) << said.out;
}

TEST(Run, AValueThatCannotBeSetIsRefusedBeforeAnythingRuns) {
  const auto refusal = [](const char* act) {
    RunRequest request = lasting(milliseconds(10));
    request.at = {act};
    const Said said = said_by(request, kGain);
    EXPECT_EQ(said.code, kUsage) << act;
    return said.err.substr(said.err.find("--at"));
  };
  EXPECT_EQ(refusal("1 ms: set k 3"),
            "--at '1 ms: set k 3': 'k' is a constant, which nothing changes while tasks run; for the whole run: "
            "--set k VALUE\n");
  EXPECT_EQ(refusal("1 ms: set y 3"), "--at '1 ms: set y 3': 'y' is produced by task 'gain'; operator variables and "
                                      "constants of the file can be set\n");
  EXPECT_EQ(refusal("1 ms: set xy 3"),
            "--at '1 ms: set xy 3': the file has no operator variable or constant 'xy'; did you mean 'x'?\n");
  EXPECT_NE(refusal("1 ms: set x 3 m").find("expected a quantity in \"rad\", found one in \"m\""), std::string::npos)
      << refusal("1 ms: set x 3 m");
}

TEST(Run, AHotStandbyIsOffInTheTableOfOneContext) {
  RunRequest request = lasting(milliseconds(50));
  const Said said = said_by(request, R"(subsystem: s
tasks:
  main: {component: t_counter, rate: 100 Hz}
  spare: {component: t_counter, rate: 100 Hz, standby_for: {task: main, hot: true}}
)");
  EXPECT_NE(said.out.find("\nmain   ON "), std::string::npos) << said.out << said.err;
  EXPECT_NE(said.out.find("\nspare  OFF "), std::string::npos) << said.out;
}

TEST(Run, AnIllegalDescriptionIsReportedAndNotRun) {
  RunRequest request = lasting(milliseconds(1));
  const Said said = said_by(request, "");
  EXPECT_EQ(said.code, kRefused);
  EXPECT_EQ(said.out, "");
  EXPECT_NE(said.err, "");
}

TEST(ProfileReport, ATaskThatNeverRanHasNoFiguresButALine) {
  Application application = test_application(kCounterText, test_library());
  const auto profiles = profiles_of(application.all_tasks(), application.states(), application.configuration(), {});
  EXPECT_EQ(profile_table(profiles, Nanoseconds{}, Nanoseconds{}),
            "task     state          cycles        mean        max      load    response      jitter  missed dropped "
            "faults\n"
            "counter  NOT-CREATED         0           -          -    0.00 %           -           -       0      0   "
            "   0\n");
  EXPECT_EQ(profile_json(profiles, Nanoseconds{}).dump(Json::Style::kSpaced),
            "[{\"task\": \"counter\", \"component\": \"t_counter\", \"rtpu\": \"main\", \"state\": \"NOT-CREATED\", "
            "\"period_ns\": 1000000, \"server\": null, \"on_ns\": 0, "
            "\"cycles\": 0, \"execution_ns\": {}, \"response_ns\": {\"count\": 0}, "
            "\"start_delay_ns\": {\"count\": 0}, \"transfer\": {\"groups\": 0, \"bytes\": 0}, "
            "\"missed\": 0, \"overrun\": 0, \"min_refused\": 0, \"dropped\": 0, \"held\": 0, \"aborted\": 0, "
            "\"partial\": 0, \"tolerated\": 0, \"stale\": 0, \"rejected\": 0, \"preempted\": 0, \"demoted\": 0, "
            "\"events\": 0, \"events_lost\": 0, \"exhausted\": 0, \"faults\": 0}]");
}

TEST(ProfileReport, FaultsAreTimedFromTheOrigin) {
  Application application = test_application(kCounterText, test_library());
  Task& task = application.tasks().tasks()[0];
  task.faults.count = 1;
  task.faults.at = seconds(5000);
  task.faults.method = Method::kCycle;
  std::snprintf(task.faults.last.text, sizeof task.faults.last.text, "worn");
  const auto profiles = profiles_of(application.all_tasks(), application.states(), application.configuration(), {});
  EXPECT_NE(profile_table(profiles, seconds(2), seconds(4999))
                .find("counter: last fault in cycle at 1.00 s: worn\n"), std::string::npos);
  EXPECT_EQ(profile_json(profiles, seconds(4999))[0]["last_fault"]["at_ns"], 1'000'000'000);
}

}  // namespace
}  // namespace chimera::cli
