// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/control_server.h"

#include <grp.h>
#include <sys/wait.h>

#include <algorithm>
#include <functional>
#include <thread>

#include "chimera/control/testing/control_server_rig.h"
#include "chimera/text/json.h"

namespace chimera::control {

void FakeBackend::call(const MethodRule& method, const Json& parameters, const Caller& caller, Reply reply) {
  ++calls;
  called.emplace_back(method.name);
  if (called.back() == "status" && busy_us > 0) ::usleep(static_cast<useconds_t>(busy_us));
  if (std::string(method.name) == "signal") return later.push_back(std::move(reply));
  if (std::string(method.name) == "library") return;
  reply(RpcResponse::good({{"method", method.name},
                           {"params", parameters},
                           {"role", role_name(caller.role)},
                           {"ballast", std::string(ballast, 'x')}}));
}

RpcResponse FakeBackend::open(std::uint64_t subscription, const Json& parameters) {
  if (parameters.contains("variables") && parameters["variables"][0] == "nothing")
    return RpcResponse::unknown("no state variable 'nothing'", "variables", "something");
  opened.push_back(subscription);
  return {};
}

std::shared_ptr<const Json> FakeBackend::pull(std::uint64_t) {
  if (news == 0) return nullptr;
  --news;
  return std::make_shared<const Json>(Json{{"n", ++pulls}, {"ballast", std::string(ballast, 'x')}});
}

namespace {

TEST_F(DoorTest, AnswersARequestWithItsId) {
  const int fd = plain();
  EXPECT_EQ(ask(fd, "{\"jsonrpc\":\"2.0\",\"id\":\"a\",\"method\":\"hello\"}\n"),
            "{\"id\":\"a\",\"jsonrpc\":\"2.0\",\"result\":{\"ballast\":\"\",\"method\":\"hello\",\"params\":{},"
            "\"role\":\"configure\"}}\n");
  ::close(fd);
}

TEST_F(DoorTest, TakesRequestsInPiecesAndSeveralAtOnce) {
  const int fd = plain();
  const std::string text = request("hello", "{}", 1);
  for (const char c : text.substr(0, text.size() - 1)) EXPECT_EQ(ask(fd, std::string(1, c)), "");
  EXPECT_EQ(count(ask(fd, "\n" + request("hello", "{}", 2) + request("status", "{}", 3)), "\"result\""), 3u);
  ::close(fd);
}

TEST_F(DoorTest, TwoPeersGetTheirOwnAnswers) {
  const int a = plain(), b = plain();
  say(a, request("hello", "{}", 1));
  say(b, request("status", "{}", 2));
  serve();
  EXPECT_NE(take(a).find(R"("id":1,)"), std::string::npos);
  EXPECT_NE(take(b).find(R"("id":2,)"), std::string::npos);
  ::close(a);
  ::close(b);
}

TEST_F(DoorTest, RefusesALineThatIsNoRequestAndGoesOn) {
  const int fd = plain();
  EXPECT_EQ(ask(fd, "no json\n"), error("null", -32700, "this is no JSON"));
  EXPECT_EQ(ask(fd, "\n"), error("null", -32700, "this is no JSON"));
  EXPECT_EQ(ask(fd, std::string("\xff\xfe\0{}\n", 6)), error("null", -32700, "this is no JSON"));
  EXPECT_EQ(ask(fd, "[]\n"), error("null", -32600, "batches are not supported: send one message a line"));
  EXPECT_NE(ask(fd, request("hello")).find("\"result\""), std::string::npos);
  ::close(fd);
}

TEST_F(DoorTest, NamesTheNearestMethod) {
  const int fd = plain();
  EXPECT_EQ(ask(fd, request("statsu")),
            R"({"error":{"code":-32601,"data":{"nearest":"status","where":"method"},"message":"no method 'statsu'"},)"
            R"("id":1,"jsonrpc":"2.0"})"
            "\n");
  EXPECT_EQ(ask(fd, request("flag", R"({"up":1})")),
            R"({"error":{"code":-32602,"data":{"where":"up"},"message":"'up' must be true or false"},"id":1,)"
            R"("jsonrpc":"2.0"})"
            "\n");
  EXPECT_EQ(backend.calls, 0);
  ::close(fd);
}

TEST_F(DoorTest, ARequestWithoutIdIsCarriedOutAndNotAnswered) {
  const int fd = plain();
  EXPECT_EQ(ask(fd, R"({"jsonrpc":"2.0","method":"flag","params":{"up":true}})"
                    "\n"),
            "");
  EXPECT_EQ(backend.calls, 1);
  EXPECT_EQ(ask(fd, R"({"jsonrpc":"2.0","method":"flog"})"
                    "\n"),
            "");
  ::close(fd);
}

TEST_F(DoorTest, AnAnswerMayComeLaterAndOnlyOnce) {
  const int fd = plain();
  const std::string off = request("signal", R"({"signal":"off","tasks":["a"]})", 9);
  EXPECT_EQ(ask(fd, off), "");
  ASSERT_EQ(backend.later.size(), 1u);
  backend.later[0](RpcResponse::error(kRefused, "not now"));
  backend.later[0](RpcResponse::error(kRefused, "still not"));
  EXPECT_LE(server->next_due(), now) << "an answer given between two turns is sent at once";
  serve();
  EXPECT_EQ(take(fd), error("9", -32000, "not now"));
  EXPECT_EQ(ask(fd, off), "");
  ::close(fd);
  serve();
  EXPECT_EQ(server->connections(), 0u);
  backend.later[1](RpcResponse::good(Json::object()));  // the connection is gone: harmless
  server.reset();
  backend.later[1](RpcResponse::good(Json::object()));
  backend.later.clear();
}

TEST_F(DoorTest, AReplyThatIsDroppedIsAnAnswerToo) {
  const int fd = plain();
  EXPECT_EQ(ask(fd, request("library")), error("1", -32006, "the subsystem gave no answer"));
  ::close(fd);
}

TEST_F(DoorTest, APeerThatSaysNothingMoreIsStillAnswered) {
  const int fd = plain();
  say(fd, request("signal", R"({"signal":"off","tasks":["a"]})"));
  ::shutdown(fd, SHUT_WR);
  serve();
  EXPECT_EQ(server->connections(), 1u);
  EXPECT_EQ(server->next_due(), kNever) << "it is waited for, not asked again and again";
  backend.later.at(0)(RpcResponse::good(Json::object()));
  serve();
  EXPECT_EQ(take(fd), R"({"id":1,"jsonrpc":"2.0","result":{}})"
                      "\n");
  EXPECT_TRUE(is_closed(fd));
  EXPECT_EQ(server->connections(), 0u);
  ::close(fd);
}

TEST_F(DoorTest, CarriesOutRequestsOfAClientThatHasGone) {
  const int fd = plain();
  std::string acts;
  for (int i = 0; i < 40; ++i) acts += request("flag", R"({"up":true})");
  say(fd, acts);
  ::close(fd);
  serve();
  EXPECT_GE(backend.calls, 32);
  EXPECT_EQ(server->connections(), 0u);
}

TEST_F(DoorTest, ActsComeBeforeTheQuestionsOfOthersAndATurnEnds) {
  const int loud = plain(), quiet = plain();
  serve();
  backend.busy_us = 2000;
  for (int i = 0; i < 30; ++i) say(loud, request("status"));
  say(quiet, request("flag", R"({"up":true})"));
  server->serve(now = now + milliseconds(1));
  ASSERT_FALSE(backend.called.empty());
  EXPECT_EQ(backend.called[0], "flag");
  EXPECT_LE(backend.called.size(), 4u) << "of 30 questions that take 2 ms each two or three are a turn";
  EXPECT_NE(take(quiet).find("\"result\""), std::string::npos) << "answered in this turn";
  EXPECT_LE(server->next_due(), now) << "there is more to do";
  serve();
  EXPECT_EQ(backend.called.size(), 31u);
  ::close(loud);
  ::close(quiet);
}

TEST_F(DoorTest, QuestionsOfConnectionsAreAnsweredInTurnAndEachInItsOrder) {
  const int a = plain(), b = plain();
  serve();
  backend.busy_us = 1;
  say(a, request("status") + request("hello") + request("flag", R"({"up":true})") + request("hello"));
  say(b, request("get") + request("profile"));
  serve();
  EXPECT_EQ(backend.called, (std::vector<std::string>{"status", "get", "hello", "flag", "profile", "hello"}))
      << "an act waits for earlier requests of its own connection only";
  ::close(a);
  ::close(b);
}

TEST_F(DoorTest, TheBackendForgetsAConnectionThatIsClosed) {
  const int fd = plain();
  serve();
  EXPECT_TRUE(backend.forgotten.empty());
  ::close(fd);
  serve();
  EXPECT_EQ(backend.forgotten, std::vector<std::uint64_t>{1});
}

TEST_F(DoorTest, SubscriptionsComeWithTheirPeriodAndEndWithTheConnection) {
  const int fd = plain();
  EXPECT_NE(ask(fd, request("subscribe", R"({"to":"status","period_ms":50})")).find(R"("subscription":1)"),
            std::string::npos);
  for (int i = 0; i < 200; ++i) serve();
  EXPECT_GE(backend.pulls, 4);
  EXPECT_LE(backend.pulls, 5);
  EXPECT_NE(take(fd).find(R"({"jsonrpc":"2.0","method":"status","params":{"ballast":"","n":2,"subscription":1}})"),
            std::string::npos);
  EXPECT_NE(ask(fd, request("subscribe", R"({"to":"tap","variables":["nothing"]})")).find(R"("nearest":"something")"),
            std::string::npos);
  ::close(fd);
  serve();
  EXPECT_EQ(backend.closed, backend.opened);
  EXPECT_EQ(server->next_due(), kNever);
}

TEST_F(DoorTest, TheFirstNotificationComesWithTheAnswerNotAfterAPeriod) {
  const int fd = plain();
  const std::string got = ask(fd, request("subscribe", R"({"to":"status","period_ms":60000})"));
  const std::size_t answer = got.find(R"("result":{"subscription":1})"), note = got.find(R"("method":"status")");
  EXPECT_NE(note, std::string::npos);
  EXPECT_LT(answer, note) << "the answer first, so that the number is known";
  EXPECT_EQ(backend.pulls, 1);
  ::close(fd);
}

TEST_F(DoorTest, ALateTurnSendsOneStatusOnly) {
  const int fd = plain();
  ask(fd, request("subscribe", R"({"to":"status","period_ms":50})"));
  const int before = backend.pulls;
  serve(seconds(1));
  EXPECT_EQ(backend.pulls, before + 1);
  ::close(fd);
}

TEST_F(DoorTest, ASubscriptionIsEndedByItsOwnConnectionOnly) {
  const int a = plain(), b = plain();
  ask(a, request("subscribe", R"({"to":"status"})"));
  EXPECT_NE(ask(b, request("unsubscribe", R"({"subscription":1})")).find("no subscription 1"), std::string::npos);
  EXPECT_TRUE(backend.closed.empty());
  EXPECT_NE(ask(a, request("unsubscribe", R"({"subscription":1})")).find(R"("result":{})"), std::string::npos);
  EXPECT_EQ(backend.closed.size(), 1u);
  ::close(a);
  ::close(b);
}

TEST_F(DoorTest, NewsWithoutPeriodComeAllOfThemInOrder) {
  const int fd = plain();
  backend.news = 150;
  std::string got = ask(fd, request("subscribe", R"({"to":"events"})"));
  for (int i = 0; i < 60; ++i, got += take(fd)) serve();
  EXPECT_EQ(count(got, R"("method":"events")"), 150u);
  EXPECT_LT(got.find(R"("n":1,)"), got.find(R"("n":150,)"));
  ::close(fd);
}

/// The bytes that a child of another user and group reads from ControlServer; "" when it cannot connect.
std::string as_stranger(const std::string& path, gid_t group, const std::string& text,
                        const std::function<void()>& serve) {
  int pipe[2];
  if (::pipe(pipe) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setgroups(1, &group) != 0 || ::setgid(65534) != 0 || ::setuid(65534) != 0) ::_exit(9);
    const int fd = DoorTest::plain_to(path);
    if (fd < 0) ::_exit(8);
    (void)!::send(fd, text.data(), text.size(), MSG_NOSIGNAL);
    char bytes[512];
    const ssize_t got = ::recv(fd, bytes, sizeof bytes, 0);
    if (got > 0) (void)!::write(pipe[1], bytes, static_cast<std::size_t>(got));
    ::_exit(0);
  }
  EXPECT_TRUE(await_that([&] { return serve(), ::waitpid(child, nullptr, WNOHANG) != 0; }));
  ::close(pipe[1]);
  char bytes[512];
  const ssize_t got = ::read(pipe[0], bytes, sizeof bytes);
  ::close(pipe[0]);
  return {bytes, static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
}

struct StrangerTest : DoorTest {
  void SetUp() override {
    if (::getuid() != 0) GTEST_SKIP() << "only root can become another user";
    DoorTest::SetUp();
    std::filesystem::permissions(folder, std::filesystem::perms::all);
    std::filesystem::permissions(path, std::filesystem::perms::all);
  }
};

TEST_F(StrangerTest, GetsOnlyTheAnswerThatItHasNoRole) {
  const auto got = as_stranger(path, 65534, request("hello") + request("flag", R"({"up":true})"), [&] { serve(); });
  EXPECT_EQ(got, R"({"error":{"code":-32004,"data":{"has":"nothing","needs":"observe"},"message":"you have no role )"
                 R"(in this subsystem: you are neither its user nor in a group that has a role"},"id":null,)"
                 R"("jsonrpc":"2.0"})"
                 "\n");
  EXPECT_EQ(backend.calls, 0);
  EXPECT_EQ(server->connections(), 0u);
}

TEST_F(StrangerTest, AMemberOfAGroupHasOnlyItsRole) {
  groups.observe = 4242;
  open_door();
  EXPECT_NE(as_stranger(path, 4242, request("hello"), [&] { serve(); }).find(R"("role":"observe")"), std::string::npos);
  EXPECT_EQ(as_stranger(path, 4242, request("flag", R"({"up":true})"), [&] { serve(); }),
            R"({"error":{"code":-32004,"data":{"has":"observe","needs":"operate"},"message":"'flag' needs the role )"
            R"(operate, you have observe"},"id":1,"jsonrpc":"2.0"})"
            "\n");
  EXPECT_EQ(backend.calls, 1);
}

}  // namespace
}  // namespace chimera::control
