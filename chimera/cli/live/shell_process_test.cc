// SPDX-License-Identifier: Apache-2.0
// Commands over a real socket, before a subject that is a test's.
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>
#include <thread>
#include <utility>

#include "chimera/base/testing/await.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/interactive.h"
#include "chimera/cli/live/testing/test_answers.h"
#include "chimera/control/control_server.h"
#include "chimera/platform/clock.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

Call read_call(const std::vector<std::string>& words) { return cli::read_call(shell_words(), words, "").call; }

using control::RpcResponse;

/// Two tasks and the variables of test_answers.h; `error` rises by 1 mrad a row.
struct FakeSubject final : control::ControlBackend {
  void call(const control::MethodRule& method, const Json& parameters, const control::Caller&,
            control::Reply reply) override {
    const std::string name = method.name;
    calls += name + " " + parameters.dump() + "\n";
    if (name == "status") {
      Json status = Json::parse(test::kStatus);
      if (origin.count > 0) status["origin_ns"] = origin.count;
      return reply(RpcResponse::good(status));
    }
    if (name == "describe") return reply(RpcResponse::good(Json::parse(test::kDescribed)));
    if (name == "hello")
      return reply(RpcResponse::good({{"subsystem", "puma_pid"},
                                      {"file", file},
                                      {"keeper_pid", 1},
                                      {"session", session},
                                      {"folder", "/srv/bo"},
                                      {"manager", {{"pid", 12}, {"starts", 1}}}}));
    if (name == "save") return reply(RpcResponse::good({{"operator", {{"kp", "[1 N.m/rad, 2 N.m/rad]"}}}}));
    if (name == "check") return reply(RpcResponse::good({{"legal", is_legal}, {"faults", Json::array()}}));
    if (name == "signal") return signal(parameters, reply);
    if (name == "get" && parameters.dump().find("sequence_steps") != std::string::npos)
      return reply(RpcResponse::good(Json::parse(test::kSequence)));
    if (const Json* go = parameters["values"].find("sequence_go"); name == "set" && go != nullptr)
      return reply(RpcResponse::good({{"values", {{"sequence_go", {{"value", *go}}}}}}));
    if (name == "get") return reply(RpcResponse::good({{"values", {{"error", reading(0.5)}}}}));
    if (name == "events") return reply(RpcResponse::good({{"events", Json::array()}, {"first", 1}, {"last", 0}}));
    reply(RpcResponse::error(control::kRefused, "not now", {{"where", "kp"}, {"remedy", "off first"}}));
  }
  void signal(const Json& parameters, const control::Reply& reply) {
    Json tasks = Json::array();
    for (const Json& task : parameters["tasks"]) {
      if (task == "pdi") return reply(RpcResponse::unknown("no task 'pdi'", "pdi", "pid"));
      tasks.push_back({{"task", task}, {"before", "OFF"}, {"after", "ON"}});
    }
    reply(RpcResponse::good({{"tasks", tasks}}));
  }
  static Json reading(double value) {
    return {{"value", value}, {"text", Json(value).dump() + " rad"}, {"unit", "rad"}, {"producer", "pid"},
            {"state", "ON"}, {"sequence", 1}, {"age_ns", 1000}, {"valid", true}};
  }
  RpcResponse open(std::uint64_t subscription, const Json& parameters) override {
    to[subscription] = text_at(parameters, "to");
    return {};
  }
  void close(std::uint64_t subscription) override { to.erase(subscription); }
  std::shared_ptr<const Json> pull(std::uint64_t subscription) override {
    if (to[subscription] == "values") return std::make_shared<const Json>(Json{{"values", {{"error", reading(0)}}}});
    if (to[subscription] == "status") return std::make_shared<const Json>(Json::parse(test::kStatus));
    if (to[subscription] != "tap" || row >= 20) return nullptr;
    if (row == 0) begun = LinuxClock().now();
    const std::int64_t n = row++, at = (begun + milliseconds(n)).count;
    const std::int64_t lost = n >= 12 ? 3 : 0;  // three rows are gone there
    const Json line = Json::array({at, n + lost + 1, Json::array({static_cast<double>(n) * 1e-3})});
    return std::make_shared<const Json>(Json{{"rtpu", "servo"}, {"task", "pid"}, {"variables", {"error"}},
                                             {"first", n + lost}, {"lost", n == 12 ? 3 : 0},
                                             {"rows", Json::array({line})}});
  }

  std::string calls, file;
  std::int64_t session = ::getsid(0);  ///< of this terminal
  std::map<std::uint64_t, std::string> to;
  std::int64_t row = 0;
  Nanoseconds begun;   ///< when the first row was asked for
  Nanoseconds origin;  ///< 0: that of test_answers.h
  bool is_legal = true;
};

/// A ControlServer on a thread of its own, a folder for all files, and the output of commands.
struct ShellTest : ::testing::Test {
  void SetUp() override {
    char made[] = "/tmp/chimera-shell-XXXXXX";
    folder = ::mkdtemp(made);
    ::setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
    ::setenv("XDG_STATE_HOME", folder.c_str(), 1);
    ::unsetenv("CHIMERA_SUBSYSTEM");
  }
  void serve() {
    ::mkdir((folder + "/chimera").c_str(), 0700);
    const std::string path = folder + "/chimera/puma_pid.sock";
    const int listening = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path.c_str());
    ASSERT_EQ(::bind(listening, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ASSERT_EQ(::listen(listening, 64), 0);
    keepers = ::dup(listening);
    open(listening);
  }
  /// Starts another ControlServer on the same socket, as a keeper does.
  void restart() {
    stop();
    is_over = false;
    open(::dup(keepers));
  }
  void open(int listening) {
    server = *control::ControlServer::open(listening, subject, ::getuid(), {});
    serving = std::thread([this] {
      sigset_t all;
      ::sigfillset(&all);
      ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
      while (!is_over) {
        pollfd one{server->descriptor(), POLLIN, 0};
        ::poll(&one, 1, 2);
        server->serve(LinuxClock().now());
      }
    });
  }
  void stop() {
    is_over = true;
    if (serving.joinable()) serving.join();
    server.reset();
  }
  void TearDown() override {
    stop();
    ::close(keepers);
    std::filesystem::remove_all(folder);
  }
  Surroundings surroundings(const std::string& subsystem = "") const {
    return {subsystem, {source_path("share/chimera/units.xml")}};
  }
  /// Exit code, standard output and standard error of a command.
  std::string run(const std::vector<std::string>& words, const std::string& subsystem = "") {
    std::FILE *out = std::tmpfile(), *err = std::tmpfile();
    const int code = carry_out(surroundings(subsystem), read_call(words), out, err);
    return std::to_string(code) + "|" + text(out) + "|" + text(err);
  }
  static std::string text(std::FILE* file) {
    std::string all(static_cast<std::size_t>(std::ftell(file)), ' ');
    std::rewind(file);
    all.resize(std::fread(all.data(), 1, all.size(), file));
    std::fclose(file);
    return all;
  }
  std::string path(const std::string& name) const { return folder + "/" + name; }
  static std::string content(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }

  std::string folder;
  int keepers = -1;  ///< the listening socket, which outlives a ControlServer
  FakeSubject subject;
  std::unique_ptr<control::ControlServer> server;
  std::thread serving;
  std::atomic<bool> is_over{false};
};

TEST_F(ShellTest, NoSubsystemIsOneClearSentence) {
  EXPECT_EQ(run({"status"}), "1||" + folder + "/chimera: no subsystem runs; start one with `chimera run FILE`\n");
  EXPECT_EQ(run({"status"}, "arm"), "1||no subsystem 'arm' runs; start one with `chimera run FILE`\n");
}

TEST_F(ShellTest, AnAnswerIsTextOrRaw) {
  serve();
  EXPECT_EQ(run({"status"}).substr(0, 56), "0|puma_pid: run, up 12.5 min, flag UP by spare, operator");
  EXPECT_EQ(run({"status", "--json"}), "0|" + Json::parse(test::kStatus).dump() + "\n|");
  EXPECT_EQ(run({"get", "error"}), "0|error = 0.5 rad  (pid, 1.00 us ago)\n|[puma_pid]\n");
}

TEST_F(ShellTest, ARefusalHasTheServersWordsAndTheNearestName) {
  serve();
  EXPECT_EQ(run({"off", "pdi"}), "1||[puma_pid] no task 'pdi'; did you mean 'pid'?\n");
  EXPECT_EQ(run({"set", "kp", "[100", "90]", "N.m/rad"}), "1||[puma_pid] kp: not now; off first\n");
  EXPECT_NE(subject.calls.find(R"(set {"values":{"kp":"[100 90] N.m/rad"}})"), std::string::npos) << subject.calls;
  const std::string raw = run({"off", "pdi", "--json"});
  const Json error = Json::parse(raw.substr(2, raw.size() - 3));
  EXPECT_EQ(error["error"]["code"], control::kUnknown);
  EXPECT_EQ(error["error"]["nearest"], "pid");
  EXPECT_EQ(run({"flag", "sideways"}), "2||[puma_pid] flag: found 'sideways', expected up or down\n");
  EXPECT_EQ(run({"events", "--since", "x"}),
            "2||[puma_pid]\n--since: found 'x', expected the number of an event, a time ago such as '10 min', or a "
            "time such as '14:05' or '2026-11-28 14:05'\n");
}

TEST_F(ShellTest, AnActOnASubsystemOfAnotherTerminalAndFolderWantsItsName) {
  subject.session = ::getsid(0) + 1;
  serve();
  EXPECT_EQ(run({"off", "pid"}),
            "1||'puma_pid' was started in /srv/bo (process 1), not from this terminal or folder; if you mean it, "
            "type: chimera off pid --subsystem puma_pid\n");
  EXPECT_EQ(run({"set", "kp", "[1 2] N.m/rad", "--json"}).substr(0, 20), "1|{\"error\":{\"message");
  EXPECT_EQ(run({"save", "--write"}).substr(0, 23), "1||'puma_pid' was start");
  EXPECT_EQ(run({"status", "--pid", "servo"}).substr(0, 23), "1||'puma_pid' was start");
  EXPECT_EQ(subject.calls.find("signal"), std::string::npos) << subject.calls;
  EXPECT_EQ(subject.calls.find("set"), std::string::npos) << subject.calls;
  EXPECT_EQ(run({"get", "error"}).substr(0, 2), "0|") << "a question is no act";
  EXPECT_EQ(run({"on", "pid"}, "puma_pid"), "0|[puma_pid] pid: OFF -> ON\n|");
  EXPECT_EQ(run({"on", "pid"}, folder + "/chimera/puma_pid.sock"), "0|[puma_pid] pid: OFF -> ON\n|");
  ::setenv("CHIMERA_SUBSYSTEM", "puma_pid", 1);
  EXPECT_EQ(run({"on", "pid"}), "0|[puma_pid] pid: OFF -> ON\n|");
  ::unsetenv("CHIMERA_SUBSYSTEM");
}

TEST_F(ShellTest, AnswersOfProgramsNameTheirSubsystem) {
  serve();
  EXPECT_EQ(run({"on", "pid", "--json"}),
            "0|{\"subsystem\":\"puma_pid\",\"tasks\":[{\"after\":\"ON\",\"before\":\"OFF\",\"task\":\"pid\"}]}\n|");
  const std::string raw = run({"off", "pdi", "--json"});
  EXPECT_EQ(Json::parse(raw.substr(2, raw.size() - 3))["subsystem"], "puma_pid");
}

TEST_F(ShellTest, TheProcessOfAnRtpuIsANumberForKill) {
  serve();
  EXPECT_EQ(run({"status", "--pid", "servo"}), "0|4711\n|");
  EXPECT_EQ(run({"status", "--pid", "keeper"}), "0|1\n|");
  EXPECT_EQ(run({"status", "--pid", "manager"}), "0|12\n|");
  EXPECT_EQ(run({"status", "--pid", "sevro"}), "1||--pid: no rtpu 'sevro'; did you mean 'servo'?\n");
  EXPECT_EQ(run({"status", "--pid", "spare"}), "1||--pid: the process of 'spare' is dead\n");
}

TEST_F(ShellTest, AConfigurationStandsForItsTasks) {
  serve();
  EXPECT_EQ(run({"on", "run"}), "0|[puma_pid] trajectory: OFF -> ON\n|") << "the others are ON";
  EXPECT_EQ(run({"on", "hand"}), "0|[puma_pid] all of its tasks are ON\n|");
}

TEST_F(ShellTest, AScriptStopsAtTheFirstRefusalAndNamesItsLine) {
  serve();
  auto session = Session::open(surroundings());
  ASSERT_TRUE(session);
  for (const bool keeps_going : {false, true}) {
    std::istringstream script("# take it\non pid\n\noff pdi   # a slip\nstatsu\noff arm\nquit\non arm\n");
    std::FILE *out = std::tmpfile(), *err = std::tmpfile();
    EXPECT_EQ(run_script(*session, script, "a.txt", keeps_going, out, err), kRefused);
    EXPECT_EQ(text(out), keeps_going ? "[puma_pid] pid: OFF -> ON\n[puma_pid] arm: OFF -> ON\n"
                                     : "[puma_pid] pid: OFF -> ON\n");
    const std::string first = "[puma_pid] no task 'pdi'; did you mean 'pid'?\na.txt:4: refused: off pdi   # a slip\n";
    const std::string second = "no command 'statsu'; did you mean 'status'?; `help` lists them\n"
                               "a.txt:5: refused: statsu\n";
    EXPECT_EQ(text(err), keeps_going ? first + second : first);
  }
}

TEST_F(ShellTest, ASequenceGoesToAStepByItsName) {
  serve();
  const std::string waits = "> 2 grip  waits for distance <= 5 mm, 1.5 s of 10 s\n";
  EXPECT_EQ(run({"sequence"}), "0|[puma_pid]   1 near\n[puma_pid] " + waits + "[puma_pid]   3 home\n|");
  EXPECT_EQ(run({"sequence", "go", "home"}), "0|[puma_pid] goes to step 3\n|");
  EXPECT_EQ(run({"sequence", "pause"}), "0|[puma_pid] paused\n|");
  EXPECT_EQ(run({"sequence", "go", "hmoe"}), "2||[puma_pid] sequence: no step 'hmoe'; did you mean 'home'?\n");
}

TEST_F(ShellTest, AScopeRecordsRoundItsTriggerAndCountsItsGaps) {
  serve();
  const std::string said = run({"scope", "error", "--trigger", "error > 9.5 mrad", "--pre", "5 ms", "--for", "5 ms",
                                "--csv", path("a.csv"), "--svg", path("a.svg"), "--wait", "60 s"});
  EXPECT_EQ(said.substr(0, 14), "0||[puma_pid]\n") << said;
  EXPECT_NE(said.find("recording the pre-trigger of 5.00 ms first"), std::string::npos) << said;
  EXPECT_NE(said.find("; 1 gap, 3 rows lost\n"), std::string::npos) << said;
  const std::string csv = content(path("a.csv"));
  EXPECT_EQ(csv.rfind("t(s),error(rad),lost\n", 0), 0u) << csv;
  EXPECT_NE(csv.find("\n0.000000000,0.01,0\n"), std::string::npos) << csv;
  EXPECT_NE(content(path("a.svg")).find("3 rows of pid lost"), std::string::npos);
}

TEST_F(ShellTest, AScopeRefusesImpossibleArguments) {
  serve();
  EXPECT_EQ(run({"scope", "eror"}), "1||[puma_pid]\nno state variable 'eror'; did you mean 'error'?\n");
  EXPECT_EQ(run({"scope", "ndof"}), "2||[puma_pid]\n'ndof' is a constant: no task publishes it\n");
  EXPECT_EQ(run({"scope", "error", "--pre", "1 s"}), "2||[puma_pid]\n--pre belongs to --trigger\n");
  EXPECT_EQ(run({"scope", "error", "--trigger", "q > 1 rad"}),
            "2||[puma_pid]\ntrigger 'q > 1 rad': say which element, such as q[0]\n");
  EXPECT_EQ(run({"scope", "error", "--trigger", "error > 9 rad", "--wait", "300 ms"}),
            "1||[puma_pid]\nno trigger 'error > 9 rad' within 300 ms\n");
}

TEST_F(ShellTest, WatchGoesOnUntilCtrlC) {
  serve();
  sigset_t interrupt;
  ::sigemptyset(&interrupt);
  ::sigaddset(&interrupt, SIGINT);
  const pthread_t me = ::pthread_self();
  std::FILE *const out = std::tmpfile(), *const err = std::tmpfile();
  std::thread user([me, written = ::fileno(out)] {
    struct stat seen {};
    EXPECT_TRUE(await_that([&] { return ::fstat(written, &seen) == 0 && seen.st_size >= 32; })) << "two rows of 16";
    ::pthread_kill(me, SIGINT);
  });
  ::pthread_sigmask(SIG_BLOCK, &interrupt, nullptr);  // as it is while the command runs, from before the user types
  const int code = carry_out(surroundings(), read_call({"watch", "error", "--every", "20 ms"}), out, err);
  user.join();
  const std::string said = std::to_string(code) + "|" + text(out) + "|" + text(err);
  EXPECT_EQ(said.rfind("0|error = 0.0 rad\nerror = 0.0 rad\n", 0), 0u) << said;
}

TEST_F(ShellTest, SaveWritesTheFileOnceAndOnlyIfItIsUnchanged) {
  subject.file = path("arm.yaml");
  const std::string before = "subsystem: puma_pid\ntasks: {a: }\noperator:\n  kp: [3 N.m/rad, 2 N.m/rad]  # gains\n";
  std::ofstream(subject.file) << before;
  serve();
  EXPECT_EQ(run({"save"}), "0|operator:\n  kp: [1 N.m/rad, 2 N.m/rad]\n|[puma_pid]\n");
  const std::string refusal =
      "1||[puma_pid] " + subject.file + ": has changed since the subsystem was started from it; nothing was written\n";
  EXPECT_EQ(run({"save", "--write"}), refusal) << "it started when the machine did, before the file was written";
  EXPECT_EQ(content(subject.file), before);
  subject.origin = LinuxClock().now();
  subject.is_legal = false;
  EXPECT_EQ(run({"save", "--write"}),
            "1||[puma_pid] " + subject.file + ": with these values the description is not legal: not legal\n");
  EXPECT_EQ(content(subject.file), before);
  subject.is_legal = true;
  EXPECT_EQ(run({"save", "--write"}), "0|[puma_pid] " + subject.file + ": written\n|");
  const std::string after = "subsystem: puma_pid\ntasks: {a: }\noperator:\n  kp: [1 N.m/rad, 2 N.m/rad]  # gains\n";
  EXPECT_EQ(content(subject.file), after);
  EXPECT_EQ(run({"save", "--write"}), "0|[puma_pid] " + subject.file + ": has these values already\n|")
      << "its own writing is no change";
  std::ofstream(subject.file, std::ios::app) << "# by hand\n";
  EXPECT_EQ(run({"save", "--write"}), refusal);
  EXPECT_EQ(content(subject.file), after + "# by hand\n");
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    EXPECT_EQ(entry.path().string().find("arm.yaml."), std::string::npos) << "nothing is left behind";
}

/// A command in a process of its own, on a terminal of 80 by 24.
class OnTerminal {
 public:
  /// Starts before the thread of ControlServer does: the forked process has one thread.
  template <class Run>
  explicit OnTerminal(const Run& run) {
    winsize size{24, 80, 0, 0};
    child_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (child_ != 0) return;
    ::setenv("TERM", "xterm", 1);
    ::_exit(await_that([] { return Session::open({}).has_value(); }) ? run() : -1);
  }
  ~OnTerminal() {
    if (child_ > 0) ::kill(child_, SIGKILL), ::waitpid(child_, nullptr, 0);  // still ours
    ::close(terminal_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  void type(const std::string& keys) const {
    EXPECT_EQ(::write(terminal_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  void resize(unsigned short columns, unsigned short lines) const {
    const winsize size{lines, columns, 0, 0};
    EXPECT_EQ(::ioctl(terminal_, TIOCSWINSZ, &size), 0);
  }
  /// Waits until `text` is shown, behind the text of the last call.
  bool shows(const std::string& text) {
    const Nanoseconds until = LinuxClock().now() + kHangLimit;
    while (LinuxClock().now() < until) {
      const std::size_t at = shown_.find(text, seen_);
      if (at != std::string::npos) return seen_ = at + text.size(), true;
      pollfd one{terminal_, POLLIN, 0};
      char bytes[4096];
      if (::poll(&one, 1, 100) <= 0) continue;
      const ssize_t n = ::read(terminal_, bytes, sizeof bytes);
      if (n <= 0) break;
      shown_.append(bytes, static_cast<std::size_t>(n));
    }
    ADD_FAILURE() << "not shown: " << text << "\nbut: " << shown_.substr(seen_);
    return false;
  }
  /// The exit code; -1: the command hangs.
  int ended() {
    int status = 0;
    if (!await_that([&] { return ::waitpid(child_, &status, WNOHANG) == child_; })) return -1;
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -2;
  }
  /// Shows the prompt and has the keys one by one.
  bool prompts() {
    return shows("puma_pid> ") && await_that([this] { return !is_sane(); });
  }
  bool is_sane() const {
    termios now{};
    return ::tcgetattr(terminal_, &now) == 0 && (now.c_lflag & (ICANON | ECHO)) == (ICANON | ECHO);
  }

 private:
  int terminal_ = -1;
  pid_t child_ = -1;
  std::string shown_;
  std::size_t seen_ = 0;
};

constexpr const char* kLeave = "\x1b[?25h\x1b[?1049l";

TEST_F(ShellTest, TopFillsTheScreenFollowsItsSizeAndLeavesItAsItWas) {
  OnTerminal terminal([this] { return carry_out(surroundings(), read_call({"top"}), stdout, stderr); });
  serve();
  EXPECT_TRUE(terminal.shows("\x1b[?1049h"));
  EXPECT_TRUE(terminal.shows("TASK         STATE     RATE    EXEC     MAX  BUDGET USED  JITTER MISSED INPUT   "));
  EXPECT_FALSE(terminal.is_sane()) << "keys come one by one";
  terminal.resize(100, 30);
  EXPECT_TRUE(terminal.shows("3.12 s   q_ref"));
  terminal.type("n");
  terminal.type("q");
  EXPECT_TRUE(terminal.shows(kLeave));
  EXPECT_EQ(terminal.ended(), kOk);
  EXPECT_TRUE(terminal.is_sane());
}

TEST_F(ShellTest, CtrlCLeavesTheTerminalAsItWas) {
  OnTerminal terminal([this] { return carry_out(surroundings(), read_call({"top"}), stdout, stderr); });
  serve();
  EXPECT_TRUE(terminal.shows("q quit"));
  terminal.type("\x03");
  EXPECT_TRUE(terminal.shows(kLeave));
  EXPECT_EQ(terminal.ended(), kOk);
  EXPECT_TRUE(terminal.is_sane());
}

TEST_F(ShellTest, TopEndsWithASentenceWhenTheSubsystemDoes) {
  OnTerminal terminal([this] { return carry_out(surroundings(), read_call({"top"}), stdout, stderr); });
  serve();
  EXPECT_TRUE(terminal.shows("q quit"));
  stop();
  ::close(std::exchange(keepers, -1));
  EXPECT_TRUE(terminal.shows(kLeave));
  EXPECT_TRUE(terminal.shows("the connection to the subsystem was lost"));
  EXPECT_EQ(terminal.ended(), kRefused);
  EXPECT_TRUE(terminal.is_sane());
}

TEST_F(ShellTest, TopAndWatchOutliveARestartOfTheManager) {
  OnTerminal top([this] { return carry_out(surroundings(), read_call({"top"}), stdout, stderr); });
  OnTerminal watch([this] { return carry_out(surroundings(), read_call({"watch", "error"}), stdout, stderr); });
  serve();
  EXPECT_TRUE(top.shows("q quit"));
  EXPECT_TRUE(watch.shows("0.0 rad"));
  for (int restarts = 0; restarts < 3; ++restarts) {
    restart();
    EXPECT_TRUE(top.shows("q quit"));
    EXPECT_TRUE(watch.shows("0.0 rad"));
  }
  top.type("q");
  watch.type("\x03");
  EXPECT_EQ(top.ended(), kOk);
  EXPECT_EQ(watch.ended(), kOk);
}

TEST_F(ShellTest, TheShellCompletesRemembersAndGoesOnAfterCtrlC) {
  OnTerminal terminal([this] { return interactive(surroundings("puma_pid"), "", false); });  // a session of its own
  serve();
  EXPECT_TRUE(terminal.prompts());
  terminal.type("of\tpi\t\r");
  EXPECT_TRUE(terminal.shows("[puma_pid] pid: OFF -> ON"));
  terminal.type("watch error\r");
  EXPECT_TRUE(terminal.shows("0.0 rad"));
  terminal.type("\x03");
  EXPECT_TRUE(terminal.prompts());
  terminal.type("half a line\x03");
  EXPECT_TRUE(terminal.shows("^C"));
  EXPECT_TRUE(terminal.prompts());
  terminal.type("get q\t\t");
  EXPECT_TRUE(terminal.shows("q  q_ref  "));
  terminal.type("\x15quit\r");
  EXPECT_EQ(terminal.ended(), kOk);
  EXPECT_TRUE(terminal.is_sane());
  EXPECT_NE(content(path("chimera/history")).find("pid"), std::string::npos);
}

}  // namespace
}  // namespace chimera::cli
