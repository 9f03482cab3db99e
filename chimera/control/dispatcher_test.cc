// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/dispatcher.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <map>
#include <optional>
#include <vector>

namespace chimera::control {
namespace {

/// Notes "CONNECTION METHOD" of each call and keeps its reply.
struct NotingBackend final : ControlBackend {
  void call(const MethodRule& method, const Json&, const Caller& caller, Reply reply) override {
    called.push_back(std::to_string(caller.connection) + " " + method.name);
    replies.push_back(std::move(reply));
  }
  RpcResponse open(std::uint64_t, const Json&) override { return {}; }
  void close(std::uint64_t) override {}
  std::shared_ptr<const Json> pull(std::uint64_t) override { return nullptr; }

  std::vector<std::string> called;
  std::vector<Reply> replies;
};

class DispatcherTest : public ::testing::Test {
 protected:
  /// A connection of that role; its number.
  std::uint64_t connect(Role role) {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    const std::uint64_t number = connections_.size() + 1;
    const PeerIdentity peer{.user = 1000, .role = role, .process = 0};
    clients_[number] = OwnedDescriptor(ends[0]);
    connections_[number] = std::make_unique<Connection>(number, OwnedDescriptor(ends[1]), peer, now_);
    return number;
  }
  void say(std::uint64_t number, const std::string& method, const std::string& parameters = "{}") {
    const std::string line = R"({"jsonrpc":"2.0","id":1,"method":")" + method + R"(","params":)" + parameters + "}\n";
    EXPECT_EQ(::send(clients_[number].fd, line.data(), line.size(), 0), static_cast<ssize_t>(line.size()));
    connections_[number]->receive(now_);
  }
  std::string heard(std::uint64_t number) {
    (void)connections_[number]->flush(now_);
    char bytes[4096];
    const ssize_t n = ::recv(clients_[number].fd, bytes, sizeof bytes, 0);
    return n > 0 ? std::string(bytes, static_cast<std::size_t>(n)) : "";
  }
  /// A turn has little time, and may have used it up before all that was said is carried out.
  void run_turns() {
    for (int i = 0; i < 20; ++i) dispatcher_->run_turn(now_);
  }
  using Calls = std::vector<std::string>;

  Nanoseconds now_ = seconds(1);
  NotingBackend backend_;
  Connections connections_;
  std::map<std::uint64_t, OwnedDescriptor> clients_;
  Subscriptions subscriptions_{backend_};
  std::optional<Dispatcher> dispatcher_{std::in_place, backend_, subscriptions_, connections_};
};

TEST_F(DispatcherTest, ActsGoBeforeQuestionsAndThoseOfTheHigherRoleFirst) {
  const std::uint64_t observes = connect(Role::kObserve), operates = connect(Role::kOperate),
                      configures = connect(Role::kConfigure);
  say(observes, "status");
  say(operates, "flag", R"({"up":true})");
  say(configures, "end");
  run_turns();
  EXPECT_EQ(backend_.called, (Calls{"3 end", "2 flag", "1 status"}));
}

TEST_F(DispatcherTest, AskersTakeTurnsFromOneTurnToTheNext) {
  const std::uint64_t a = connect(Role::kObserve), b = connect(Role::kObserve);
  for (int i = 0; i < 2; ++i) say(a, "status");
  say(b, "hello");
  run_turns();
  EXPECT_EQ(backend_.called, (Calls{"1 status", "2 hello", "1 status"}));
  say(a, "get");
  say(b, "get");
  run_turns();
  EXPECT_EQ(backend_.called[3], "2 get") << "the turn before ended with connection a";
}

TEST_F(DispatcherTest, AnActBehindAQuestionOfItsConnectionDoesNotOvertakeIt) {
  const std::uint64_t one = connect(Role::kConfigure);
  say(one, "status");
  say(one, "end");
  run_turns();
  EXPECT_EQ(backend_.called, (Calls{"1 status", "1 end"}));
}

TEST_F(DispatcherTest, ARequestBeyondTheRoleNeverReachesTheBackend) {
  const std::uint64_t one = connect(Role::kObserve);
  say(one, "end");
  run_turns();
  EXPECT_EQ(backend_.called, Calls{});
  EXPECT_EQ(heard(one),
            R"({"error":{"code":-32004,"data":{"has":"observe","needs":"configure"},"message":"'end' needs the role )"
            R"(configure, you have observe"},"id":1,"jsonrpc":"2.0"})"
            "\n");
}

TEST_F(DispatcherTest, AnUnknownMethodIsAnsweredWithTheNearestName) {
  const std::uint64_t one = connect(Role::kObserve);
  say(one, "stauts");
  run_turns();
  EXPECT_EQ(heard(one),
            R"({"error":{"code":-32601,"data":{"nearest":"status","where":"method"},"message":"no method 'stauts'"},)"
            R"("id":1,"jsonrpc":"2.0"})"
            "\n");
}

TEST_F(DispatcherTest, AnAnswerMayComeLaterAndCountsOnce) {
  const std::uint64_t one = connect(Role::kConfigure);
  say(one, "end");
  run_turns();
  EXPECT_EQ(connections_[one]->open_acts, 1u);
  EXPECT_FALSE(dispatcher_->has_answered());
  for (const char* text : {"first", "second"}) backend_.replies[0](RpcResponse::error(kEnding, text));
  EXPECT_TRUE(dispatcher_->has_answered());
  EXPECT_EQ(connections_[one]->open_acts, 0u);
  EXPECT_EQ(connections_[one]->open_calls, 0u);
  EXPECT_EQ(heard(one), "{\"error\":{\"code\":-32007,\"message\":\"first\"},\"id\":1,\"jsonrpc\":\"2.0\"}\n");
  dispatcher_->settle();
  EXPECT_FALSE(dispatcher_->has_answered());
}

TEST_F(DispatcherTest, AReplyThatIsDroppedIsAnAnswer) {
  const std::uint64_t one = connect(Role::kObserve);
  say(one, "status");
  run_turns();
  backend_.replies.clear();
  EXPECT_EQ(heard(one),
            "{\"error\":{\"code\":-32006,\"message\":\"the subsystem gave no answer\"},\"id\":1,"
            "\"jsonrpc\":\"2.0\"}\n");
}

TEST_F(DispatcherTest, DropsAReplyAfterTheEndOfTheConnectionOrTheDispatcher) {
  const std::uint64_t gone = connect(Role::kObserve), stays = connect(Role::kObserve);
  say(gone, "status");
  say(stays, "status");
  run_turns();
  connections_.erase(gone);
  backend_.replies[0](RpcResponse::error(kEnding, "late"));
  EXPECT_FALSE(dispatcher_->has_answered());
  dispatcher_.reset();
  backend_.replies[1](RpcResponse::error(kEnding, "later"));
  EXPECT_EQ(heard(stays), "");
}

TEST_F(DispatcherTest, LimitsTheSubscribersOfAUser) {
  for (std::size_t i = 0; i <= kMaxListenersOfUser; ++i)
    say(connect(Role::kObserve), "subscribe", R"({"to":"status"})");
  run_turns();
  EXPECT_NE(heard(kMaxListenersOfUser).find("\"result\""), std::string::npos);
  EXPECT_NE(heard(kMaxListenersOfUser + 1).find("too many connections: 12 of user 1000 have subscriptions"),
            std::string::npos);
}

}  // namespace
}  // namespace chimera::control
