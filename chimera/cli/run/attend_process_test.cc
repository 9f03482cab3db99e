// SPDX-License-Identifier: Apache-2.0
// Tests the run client with a ControlServer of a made-up subsystem.
#include "chimera/cli/run/attend.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "chimera/control/control_server.h"
#include "chimera/platform/clock.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

using control::RpcResponse;

/// A backend with one task `pid` and two rtpus. A test may change its answers before the request.
class MadeUp final : public control::ControlBackend {
 public:
  void call(const control::MethodRule& method, const Json& parameters, const control::Caller&,
            control::Reply reply) override {
    const std::string name = method.name;
    asked += name + (name == "signal" ? parameters.dump() : "") + "\n";
    if (name == "status") return reply(RpcResponse::good(status()));
    if (name == "events") {
      if (starts_at != nullptr) started_ns = starts_at;
      return reply(RpcResponse::good(news(parameters["since"].as_uint64())));
    }
    if (name == "get") return reply(RpcResponse::good({{"values", values}}));
    if (name == "profile") return reply(RpcResponse::good({{"tasks", Json::array({profile()})}}));
    if (name == "receipts") return reply(RpcResponse::good({{"receipts", receipts}}));
    if (name == "signal") return reply(RpcResponse::error(control::kRefused, "on is not legal for pid in state ON"));
    reply(RpcResponse::good(Json::object()));
  }
  RpcResponse open(std::uint64_t, const Json& parameters) override {
    asked += "subscribe" + parameters.dump() + "\n";
    return {};
  }
  void close(std::uint64_t) override {}
  std::shared_ptr<const Json> pull(std::uint64_t) override {
    if (records.empty()) return nullptr;
    auto next = std::make_shared<const Json>(records[0]);
    records.elements().erase(records.elements().begin());
    return next;
  }

  std::string asked;
  Json started_ns;
  Json starts_at;  // not null: that is known since events are asked for
  Json events = Json::array();
  Json values = Json::object();
  Json records = Json::array();  // a notification each
  Json receipts = Json::array();
  std::string fault_at_end;      // of `kill`
  Json servo = {{"name", "servo"}, {"grant", "real time: all granted"}};

 private:
  Json status() const {
    const Json spare = {{"name", "spare"}, {"grant", "WARNING: not real time\n  priority 0\n  granted: memory"}};
    return {{"subsystem", "arm"},
            {"origin_ns", 5},
            {"started_ns", started_ns},
            {"tasks", Json::array({{{"task", "pid"}}})},
            {"rtpus", Json::array({servo, spare})}};
  }
  int profiles_told = 0;
  Json news(std::uint64_t since) const {
    Json some = Json::array();
    for (const Json& event : events)
      if (event["number"].as_uint64() >= since) some.push_back(event);
    return {{"events", some}, {"first", 1}, {"last", events.size()}};
  }
  /// The first time it is asked for; after that how the end went.
  Json profile() {
    Json told = plain_profile();
    if (profiles_told++ == 0 || fault_at_end.empty()) return told;
    told["faults"] = 1;
    told["last_fault"] = {{"method", "kill"}, {"at_ns", 100}, {"code", 3}, {"text", fault_at_end}};
    return told;
  }
  static Json plain_profile() {
    return {{"task", "pid"}, {"component", "pid_joint"}, {"rtpu", "servo"}, {"state", "ON"},
            {"period_ns", 1000000}, {"server", nullptr}, {"on_ns", 100000000}, {"cycles", 100},
            {"execution_ns", Json::object()}, {"response_ns", {{"count", 0}}}, {"start_delay_ns", {{"count", 0}}},
            {"missed", 0}, {"overrun", 0}, {"min_refused", 0}, {"dropped", 0}, {"held", 0}, {"aborted", 0},
            {"partial", 0}, {"tolerated", 0}, {"stale", 0}, {"rejected", 0}, {"preempted", 0}, {"demoted", 0},
            {"events", 0}, {"events_lost", 0}, {"exhausted", 0},
            {"transfer", {{"groups", 1}, {"bytes", 48}}}, {"faults", 0}};
  }
};

class Attend : public ::testing::Test {
 protected:
  void SetUp() override {
    char made[] = "/tmp/chimera_attend_XXXXXX";
    folder_ = ::mkdtemp(made);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, (folder_ + "/arm.sock").c_str());
    listening_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    ASSERT_EQ(::bind(listening_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ASSERT_EQ(::listen(listening_, 8), 0);
    request_.socket = folder_ + "/arm.sock";
    request_.run.duration = milliseconds(60);
    backend_.started_ns = LinuxClock().now().count;
    backend_.values = {{"q", reading(Json::array({1.5, -2.0}), "[1.5 -2] rad")}, {"x", {{"value", nullptr}}}};
  }
  void TearDown() override {
    ::close(listening_);
    std::filesystem::remove_all(folder_);
  }
  static Json reading(const Json& value, const std::string& text) {
    return {{"value", value}, {"text", text}, {"unit", "rad"}, {"valid", true}};
  }
  void open_door() { door_ = *control::ControlServer::open(::dup(listening_), backend_, ::geteuid(), {}); }

  /// The exit code; out_ and err_ are what it printed. The thread of ControlServer calls the function repeatedly.
  int attend(RecordSink* sink = nullptr, std::function<void()> meanwhile = [] {}) {
    std::atomic<bool> is_over{false};
    std::thread serving([&] {
      open_door();
      for (LinuxClock clock; !is_over; meanwhile()) {
        pollfd event{door_->descriptor(), POLLIN, 0};
        ::poll(&event, 1, 1);
        door_->serve(clock.now());
      }
      door_.reset();
    });
    std::FILE* out = std::tmpfile();
    std::FILE* err = std::tmpfile();
    const int code = cli::attend(request_, sink, out, err);
    is_over = true;
    serving.join();
    out_ = taken(out);
    err_ = taken(err);
    return code;
  }
  static std::string taken(std::FILE* file) {
    std::string text;
    std::rewind(file);
    for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
    std::fclose(file);
    return text;
  }

  std::string folder_, out_, err_;
  int listening_ = -1;
  MadeUp backend_;
  std::unique_ptr<control::ControlServer> door_;
  AttendRequest request_;
};

TEST_F(Attend, PrintsRightsWatchedValuesAndTheVerdict) {
  request_.run.watch = {"q", "x"};
  request_.run.every = milliseconds(25);
  request_.run.expect = {"|q| < 3 rad", "x > 0 m"};
  request_.bounds = {{3}, {0}};
  EXPECT_EQ(attend(), kRefused);
  EXPECT_EQ(out_,
            "servo: real time: all granted\nspare: WARNING: not real time\n  priority 0\n  granted: memory\n"
            "t 0.025 s  q [1.5 -2] rad  x not written yet\nt 0.050 s  q [1.5 -2] rad  x not written yet\n"
            "ran 0.060 s\n"
            "task  state          cycles        mean        max      load    response      jitter  missed dropped "
            "faults\n"
            "pid   ON                100           -          -    0.00 %           -           -       0      0   "
            "   0\n"
            "holds: |q| < 3 rad (q is [1.5 -2] rad)\nFAILS: x > 0 m (x was never written)\n"
            "clean: no deadline missed, no release dropped, no fault, no restart\n");
  EXPECT_EQ(err_, "");
}

TEST_F(Attend, IsASuccessWhenEveryExpectationHolds) {
  request_.run.expect = {"q > -2.5 rad"};
  request_.bounds = {{-2.5}};
  request_.run.watch = {"q"};
  request_.run.json = true;
  EXPECT_EQ(attend(), kOk);
  const Json told = Json::parse(out_);
  EXPECT_EQ(told["ended"], "time");
  EXPECT_EQ(told["flag"], false);
  EXPECT_EQ(told["ran_ns"], 60'000'000);
  EXPECT_EQ(told["executor"],
            "servo: real time: all granted; spare: WARNING: not real time; priority 0; granted: memory");
  EXPECT_EQ(told["variables"]["q"], (Json{{"unit", "rad"}, {"value", {1.5, -2.0}}}));
  EXPECT_EQ(told["tasks"][0]["cycles"], 100);
  EXPECT_EQ(told["expectations"][0]["holds"], true);
}

TEST_F(Attend, PrintsTheReceiptsOfItsOwnRunForRequestsOfAllClients) {
  const auto receipt = [](int number, int origin) { return Json{{"number", number}, {"origin_ns", origin}}; };
  backend_.receipts = {receipt(8, 4), receipt(3, 5), receipt(4, 5)};  // the first is of the run before
  request_.run.json = true;
  EXPECT_EQ(attend(), kOk);
  const Json told = Json::parse(out_);
  EXPECT_EQ(told["receipts"], (Json{receipt(3, 5), receipt(4, 5)}));
  EXPECT_EQ(told["receipts_left_out"], 2) << "1 and 2 are not given out any more";
}

TEST_F(Attend, NotANumberSatisfiesNoExpectation) {
  backend_.values["q"] = reading(Json::array({1.0, nullptr}), "[1 nan] rad");
  request_.run.expect = {"q < 3 rad"};
  request_.bounds = {{3}};
  EXPECT_EQ(attend(), kRefused);
  EXPECT_NE(out_.find("FAILS: q < 3 rad (q is [1 nan] rad)\n"), std::string::npos) << out_;
}

TEST_F(Attend, ActsAtTheirTimeAndPrintsRefusals) {
  request_.run.at = {"20 ms: on pid", "10 ms: flag up"};
  const std::int64_t started = backend_.started_ns.as_int64();
  backend_.events = {{{"number", 1}, {"at_ns", started + 30'000'000}, {"kind", "refused"}, {"task", "pid"},
                      {"rtpu", nullptr}, {"text", "kill sent by other: not legal in state ON"}}};
  EXPECT_EQ(attend(), kOk);
  EXPECT_LT(backend_.asked.find("flag\n"), backend_.asked.find("signal{\"signal\":\"on\",\"tasks\":[\"pid\"]}\n"));
  EXPECT_NE(out_.find("refused at 0.030 s: pid: kill sent by other: not legal in state ON\n"), std::string::npos)
      << out_;
  EXPECT_NE(out_.find("s: on pid: on is not legal for pid in state ON\n"), std::string::npos) << out_;
}

TEST_F(Attend, AStartThatFailsIsRefusedInTheWordsOfItsTask) {
  backend_.started_ns = nullptr;
  backend_.events = {{{"number", 1}, {"at_ns", 1}, {"kind", "fault"}, {"task", "pid"}, {"rtpu", "servo"},
                      {"text", "init: no model"}}};
  EXPECT_EQ(attend(), kRefused);
  EXPECT_EQ(err_, "pid: error: init: no model\n");
  EXPECT_EQ(out_, "");
}

TEST_F(Attend, ARefusalAfterTheStartIsNoFailureOfTheStart) {
  const std::int64_t started = backend_.started_ns.as_int64();
  backend_.starts_at = std::exchange(backend_.started_ns, nullptr);
  backend_.events = {{{"number", 1}, {"at_ns", started + 2'000'000}, {"kind", "refused"}, {"task", "pid"},
                      {"rtpu", "servo"}, {"text", "kill sent by other: not legal in state ON"}}};
  EXPECT_EQ(attend(), kOk);
  EXPECT_EQ(err_, "");
  const std::string line = "refused at 0.002 s: pid: kill sent by other: not legal in state ON\n";
  ASSERT_NE(out_.find(line), std::string::npos) << out_;
  EXPECT_EQ(out_.find(line, out_.find(line) + 1), std::string::npos) << "printed once";
  backend_.started_ns = nullptr;
  backend_.events[0]["at_ns"] = started - 1;
  EXPECT_EQ(attend(), kRefused);
  EXPECT_EQ(err_, "pid: error: kill sent by other: not legal in state ON\n");
}

TEST_F(Attend, TheReactionStopOfATaskIsNoSuccess) {
  backend_.events = {{{"number", 1}, {"at_ns", 1}, {"kind", "stop"}, {"task", "pid"}, {"rtpu", "servo"},
                      {"text", "stopped by its reaction"}}};
  request_.run.duration = kNever;
  EXPECT_EQ(attend(), kRefused);
  EXPECT_NE(out_.find(", ended by the reaction `stop` of task 'pid'\n"), std::string::npos) << out_;
}

TEST_F(Attend, AFaultInKillAtTheEndIsPrintedAndFailsTheRun) {
  backend_.fault_at_end = "884 rows were not written";
  EXPECT_EQ(attend(), kRefused);
  EXPECT_NE(out_.find("\npid: last fault in kill at "), std::string::npos) << out_;
  EXPECT_NE(out_.find("not clean: 1 fault (pid 1)\nFAILED: pid: kill failed: 884 rows were not written: "
                      "its hardware may not be off or released\n"),
            std::string::npos)
      << out_;
}

TEST_F(Attend, GoesOnWithTheNextManagerWhenOneDies) {
  request_.run.duration = milliseconds(200);
  request_.run.watch = {"q"};
  request_.run.every = milliseconds(50);
  int rounds = 0;
  EXPECT_EQ(attend(nullptr, [&] {
              if (++rounds % 40 != 0) return;
              door_.reset();
              open_door();
            }),
            kOk);
  for (const char* line : {"t 0.050 s  q", "t 0.100 s  q", "t 0.150 s  q", "t 0.200 s  q", "ran 0.200 s\n"})
    EXPECT_NE(out_.find(line), std::string::npos) << out_;
}

TEST_F(Attend, HandsTheRecordsOfTheTapOn) {
  struct Sink final : RecordSink {
    void begin(const ApplicationSpec& spec, Nanoseconds at, Nanoseconds start) override {
      EXPECT_EQ(start, kNever) << "with the first release";
      text = std::string(spec.name) + " " + std::string(spec.tasks[0].name) + " " + std::string(spec.rtpus[1].name);
      origin = at;
    }
    void on_records(std::span<const TapRecord> records) override {
      for (const TapRecord& r : records)
        text += " | " + std::to_string((r.at - origin).count) + " " + std::to_string(static_cast<int>(r.kind)) + " " +
                std::to_string(r.task.index) + " " + std::to_string(r.a) + " " + std::to_string(r.b) + " " +
                std::to_string(r.rtpu);
    }
    void end(std::uint64_t lost, std::uint64_t missed) override {
      text += " | lost " + std::to_string(lost) + " missed " + std::to_string(missed);
    }
    std::string text;
    Nanoseconds origin;
  } sink;
  constexpr std::int64_t kOrigin = 5;
  backend_.records = {
      {{"rtpu", "spare"}, {"first", 0}, {"lost", 2}, {"records", Json::array()}},
      {{"rtpu", "spare"}, {"first", 2}, {"lost", 3},
       {"records", {{kOrigin + 7, "run", "pid", 2, 900}, {kOrigin + 8, "flag", nullptr, 1, 0}}}}};
  EXPECT_EQ(attend(&sink), kOk);
  EXPECT_EQ(sink.text, "arm pid spare | 7 1 0 2 900 1 | 8 8 " + std::to_string(TaskId().index) +
                           " 1 0 1 | lost 3 missed 2");
  EXPECT_NE(backend_.asked.find(R"(subscribe{"since":0,"to":"tap","variables":[]})"), std::string::npos)
      << "from the oldest record on: " << backend_.asked;
}

}  // namespace
}  // namespace chimera::cli
