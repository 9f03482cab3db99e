// SPDX-License-Identifier: Apache-2.0
// The door over a real socket, its clock stepped by the test, before a subject that is a test's.
#include "chimera/control/door.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "chimera/control/client.h"
#include "chimera/control/running.h"
#include "chimera/platform/socket_folder.h"

namespace chimera::control {
namespace {

/// Echoes; keeps the replies of `signal` until told.
struct FakeSubject final : Subject {
  void call(const MethodRule& method, const Json& parameters, Role role, Reply reply) override {
    if (std::string(method.name) == "signal") return later.push_back(std::move(reply));
    reply(Answer::good({{"method", method.name}, {"params", parameters}, {"role", role_name(role)}}));
  }
  Answer open(std::uint64_t subscription, const Json& parameters) override {
    if (parameters.contains("variables") && parameters["variables"][0] == "nothing")
      return Answer::unknown("no state variable 'nothing'", "variables", "something");
    opened.push_back(subscription);
    return {};
  }
  void close(std::uint64_t subscription) override { closed.push_back(subscription); }
  std::shared_ptr<const Json> pull(std::uint64_t) override {
    ++pulls;
    return std::make_shared<const Json>(Json{{"n", pulls}, {"ballast", std::string(ballast, 'x')}});
  }

  std::vector<Reply> later;
  std::vector<std::uint64_t> opened, closed;
  int pulls = 0;
  std::size_t ballast = 0;
};

struct DoorTest : ::testing::Test {
  void SetUp() override {
    char made[] = "/tmp/chimera-door-XXXXXX";
    folder = ::mkdtemp(made);
    path = folder + "/subject.sock";
    const int listening = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path.c_str());
    ASSERT_EQ(::bind(listening, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ASSERT_EQ(::listen(listening, 64), 0);
    door = *Door::open(listening, subject, ::getuid(), {});
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  int plain() {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path.c_str());
    EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    return fd;
  }
  void serve(Nanoseconds step = milliseconds(1)) { door->serve(now = now + step); }
  /// Sends, serves, and takes what comes back.
  std::string ask(int fd, const std::string& text) {
    EXPECT_EQ(::send(fd, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
    serve();
    serve();
    return take(fd);
  }
  static std::string take(int fd) {
    std::string got;
    char bytes[4096];
    for (ssize_t n; (n = ::recv(fd, bytes, sizeof bytes, MSG_DONTWAIT)) > 0;)
      got.append(bytes, static_cast<std::size_t>(n));
    return got;
  }
  static std::string error(const char* id, int code, const char* message) {
    return R"({"error":{"code":)" + std::to_string(code) + R"(,"message":")" + message + R"("},"id":)" + id +
           R"(,"jsonrpc":"2.0"})" + "\n";
  }

  std::string folder, path;
  FakeSubject subject;
  std::unique_ptr<Door> door;
  Nanoseconds now = seconds(1);
};

TEST_F(DoorTest, AnswersARequestWithItsId) {
  const int fd = plain();
  EXPECT_EQ(
      ask(fd, "{\"jsonrpc\":\"2.0\",\"id\":\"a\",\"method\":\"hello\"}\n"),
      "{\"id\":\"a\",\"jsonrpc\":\"2.0\",\"result\":{\"method\":\"hello\",\"params\":{},\"role\":\"configure\"}}\n");
  ::close(fd);
}

TEST_F(DoorTest, RefusesWhatIsNoRequestAndGoesOn) {
  const int fd = plain();
  EXPECT_EQ(ask(fd, "no json\n"), error("null", -32700, "this is no JSON"));
  EXPECT_EQ(ask(fd, "[]\n"), error("null", -32600, "batches are not taken: one message a line"));
  EXPECT_EQ(ask(fd, "7\n"), error("null", -32600, "a request is an object"));
  EXPECT_EQ(ask(fd, "{\"id\":1,\"method\":\"hello\"}\n"), error("1", -32600, "'jsonrpc' must be \\\"2.0\\\""));
  EXPECT_EQ(ask(fd, "{\"jsonrpc\":\"2.0\",\"id\":{},\"method\":\"hello\"}\n"),
            error("null", -32600, "'id' must be a text or a whole number"));
  EXPECT_NE(ask(fd, "{\"jsonrpc\":\"2.0\",\"id\":2,\"method\":\"hello\"}\n").find("\"result\""), std::string::npos);
  ::close(fd);
}

TEST_F(DoorTest, ClosesAfterALineThatBreaksALimit) {
  const int deep = plain();
  EXPECT_EQ(ask(deep, std::string(33, '[') + "\n"), error("null", -32001, "nested deeper than 32"));
  char byte;
  EXPECT_EQ(::recv(deep, &byte, 1, MSG_DONTWAIT), 0);
  ::close(deep);
  const int long_line = plain();
  std::thread writer([long_line] {
    const std::string bytes(kMaxLine + 2, ' ');
    (void)::send(long_line, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  });
  std::string got;
  for (int i = 0; i < 2000 && got.empty(); ++i, got = take(long_line)) {
    serve();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(got, error("null", -32001, "a line may have 1 MiB"));
  ::shutdown(long_line, SHUT_RDWR);
  writer.join();
  ::close(long_line);
}

TEST_F(DoorTest, NamesTheNearestMethodAndParameter) {
  const int fd = plain();
  EXPECT_EQ(ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"statsu"})" "\n"),
            R"({"error":{"code":-32601,"data":{"nearest":"status","where":"method"},"message":"no method 'statsu'"},)"
            R"("id":1,"jsonrpc":"2.0"})" "\n");
  EXPECT_EQ(ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"get","params":{"variable":["q"]}})" "\n"),
            R"({"error":{"code":-32602,"data":{"nearest":"variables","where":"variable"},)"
            R"("message":"'get' has no parameter 'variable'"},"id":1,"jsonrpc":"2.0"})" "\n");
  EXPECT_EQ(ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"why"})" "\n"),
            R"({"error":{"code":-32602,"data":{"where":"variable"},"message":"'why' needs 'variable'"},"id":1,)"
            R"("jsonrpc":"2.0"})" "\n");
  EXPECT_EQ(ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"flag","params":{"up":1}})" "\n"),
            R"({"error":{"code":-32602,"data":{"where":"up"},"message":"'up' must be true or false"},"id":1,)"
            R"("jsonrpc":"2.0"})" "\n");
  ::close(fd);
}

TEST_F(DoorTest, AnAnswerMayComeLater) {
  const int fd = plain();
  const std::string request = R"({"jsonrpc":"2.0","id":9,"method":"signal","params":{"signal":"off","tasks":["a"]}})";
  EXPECT_EQ(ask(fd, request + "\n"), "");
  ASSERT_EQ(subject.later.size(), 1u);
  subject.later[0](Answer::error(kRefused, "not now"));
  serve();
  EXPECT_EQ(take(fd), error("9", -32000, "not now"));
  EXPECT_EQ(ask(fd, request + "\n"), "");
  ::close(fd);
  serve();
  EXPECT_EQ(door->connections(), 0u);
  subject.later[1](Answer::good(Json::object()));  // nobody there any more: harmless
  door.reset();
  subject.later[1](Answer::good(Json::object()));
}

TEST_F(DoorTest, KeepsToItsRates) {
  const int fd = plain();
  std::string flood;
  for (int i = 0; i < 300; ++i) flood += "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"hello\"}\n";
  const std::string got = ask(fd, flood);
  std::size_t refused = 0;
  for (std::size_t at = 0; (at = got.find("too many requests", at)) != std::string::npos; ++at) ++refused;
  EXPECT_GE(refused, 95u);
  EXPECT_LE(refused, 100u);
  serve(seconds(1));
  EXPECT_EQ(ask(fd, "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"hello\"}\n").find("error"), std::string::npos);
  ::close(fd);
}

TEST_F(DoorTest, TakesSixteenConnectionsOfOneUser) {
  std::vector<int> fds;
  for (int i = 0; i < 17; ++i) fds.push_back(plain());
  serve();
  EXPECT_EQ(door->connections(), 16u);
  EXPECT_EQ(take(fds[16]), error("null", -32002, "too many connections"));
  for (const int fd : fds) ::close(fd);
  serve();
  EXPECT_EQ(door->connections(), 0u);
}

TEST_F(DoorTest, SubscriptionsComeWithTheirPeriodAndEndWithTheConnection) {
  const int fd = plain();
  EXPECT_NE(ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"to":"status","period_ms":50}})" "\n")
                .find(R"("subscription":1)"), std::string::npos);
  for (int i = 0; i < 200; ++i) serve();
  EXPECT_GE(subject.pulls, 4);
  EXPECT_LE(subject.pulls, 5);
  EXPECT_NE(take(fd).find(R"({"jsonrpc":"2.0","method":"status","params":{"ballast":"","n":2,"subscription":1}})"),
            std::string::npos);
  EXPECT_NE(ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"to":"all"}})" "\n").find("-32602"),
            std::string::npos);
  EXPECT_NE(ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"to":"tap","variables":["nothing"]}})"
                "\n").find("\"nearest\":\"something\""), std::string::npos);
  ::close(fd);
  serve();
  EXPECT_EQ(subject.closed, subject.opened);
}

TEST_F(DoorTest, ASlowReaderSkipsToTheLatestAndAStuckOneIsDropped) {
  const int fd = plain();
  subject.ballast = 200'000;
  ask(fd, R"({"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"to":"values","period_ms":20}})" "\n");
  for (int i = 0; i < 2000; ++i) serve();
  EXPECT_LT(subject.pulls, 10) << "what the peer does not take is not made";
  EXPECT_EQ(door->connections(), 1u);
  for (int i = 0; i < 40; ++i) serve(milliseconds(100));
  EXPECT_EQ(door->connections(), 0u);
  EXPECT_EQ(subject.closed.size(), 1u);
  ::close(fd);
}

TEST_F(DoorTest, RolesOpenTheMethodsThatTheyName) {
  const gid_t groups[] = {100, 200};
  EXPECT_EQ(role_of(5, groups, 5, {}), Role::kConfigure);
  EXPECT_EQ(role_of(0, groups, 5, {}), Role::kConfigure);
  EXPECT_EQ(role_of(6, groups, 5, {}), Role::kNone);
  EXPECT_EQ(role_of(6, groups, 5, {gid_t{200}, {}, {}}), Role::kObserve);
  EXPECT_EQ(role_of(6, groups, 5, {gid_t{200}, gid_t{100}, {}}), Role::kOperate);
  EXPECT_EQ(role_of(6, groups, 5, {gid_t{200}, gid_t{100}, gid_t{300}}), Role::kOperate);
}

TEST_F(DoorTest, AStrangerIsToldThatItHasNoRight) {
  if (::getuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  std::filesystem::permissions(folder, std::filesystem::perms::all);
  std::filesystem::permissions(path, std::filesystem::perms::all);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setgid(65534) != 0 || ::setuid(65534) != 0) ::_exit(9);
    const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path.c_str());
    if (::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) ::_exit(8);
    char bytes[512] = {};
    const ssize_t got = ::recv(fd, bytes, sizeof bytes - 1, 0);
    ::_exit(got > 0 && std::strstr(bytes, "-32004") != nullptr ? 0 : 7);
  }
  int status = 0;
  for (int i = 0; i < 5000 && ::waitpid(child, &status, WNOHANG) == 0; ++i) {
    serve();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(door->connections(), 0u);
}

TEST_F(DoorTest, TheClientCallsAndHearsNotifications) {
  std::atomic<bool> done = false;
  std::thread server([&] {
    while (!done) {
      pollfd one{door->descriptor(), POLLIN, 0};
      ::poll(&one, 1, 5);
      serve(milliseconds(5));
    }
  });
  {
    auto client = Client::connect_to(path);
    ASSERT_TRUE(client);
    const Answer hello = client->call("hello");
    ASSERT_TRUE(hello.is_good()) << hello.message;
    EXPECT_EQ((*hello.result)["role"], "configure");
    const Answer wrong = client->call("helo");
    EXPECT_EQ(wrong.code, kNoMethod);
    EXPECT_EQ(wrong.detail("nearest"), "hello");
    ASSERT_TRUE(client->call("subscribe", {{"to", "status"}, {"period_ms", 20}}).is_good());
    const auto note = client->next(seconds(5));
    ASSERT_TRUE(note && *note);
    EXPECT_EQ((*note)->method, "status");
    EXPECT_EQ(client->call("signal", {{"signal", "off"}, {"tasks", {"a"}}}, milliseconds(50)).code, kNoAnswer);
  }
  done = true;
  server.join();
}

TEST_F(DoorTest, TheClientFindsTheOneSubsystemThatRuns) {
  ::setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  EXPECT_EQ(socket_folder().view(), folder + "/chimera");
  const auto none = Client::connect("");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message.view(), "no subsystem runs; start one with `chimera run FILE`");
  std::filesystem::create_directory(folder + "/chimera");
  std::filesystem::rename(path, folder + "/chimera/subject.sock");
  EXPECT_EQ(running_subsystems(folder + "/chimera"), std::vector<std::string>{"subject"});
  EXPECT_TRUE(Client::connect(""));
  EXPECT_TRUE(Client::connect("subject"));
  const auto wrong = Client::connect("subjetc");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message.view(), "no subsystem 'subjetc' runs; did you mean 'subject'?");
  ::unsetenv("XDG_RUNTIME_DIR");
}

}  // namespace
}  // namespace chimera::control
