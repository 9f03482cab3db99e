// SPDX-License-Identifier: Apache-2.0
// Tests which connections get a place when places are short, and which are closed, with a stepped clock.
#include <algorithm>

#include "chimera/control/request.h"
#include "chimera/control/testing/control_server_rig.h"

namespace chimera::control {
namespace {

constexpr const char* kOff = R"({"signal":"off","tasks":["a"]})";

struct DoorPlaces : DoorTest {
  void SetUp() override {
    DoorTest::SetUp();
    server->report_closings_to([this](const std::string& text) { told.push_back(text); });
  }
  void TearDown() override {
    for (const int fd : fds) ::close(fd);
    DoorTest::TearDown();
  }
  /// Another of this process.
  int more() { return fds.emplace_back(plain()); }
  /// Another of some user in some role.
  int as(uid_t user, Role role) {
    int pair[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair), 0);
    server->enter(OwnedDescriptor(pair[0]), {user, role, 4711}, now);
    return fds.emplace_back(pair[1]);
  }
  static std::string closed(const std::string& why) { return error("null", -32008, ("closed: " + why).c_str()); }
  std::string mine(const std::string& why) const {
    return "a connection of user " + std::to_string(::getuid()) + " (process " + std::to_string(::getpid()) +
           ", configure): " + why;
  }
  std::vector<int> fds;
  std::vector<std::string> told;
};

TEST_F(DoorPlaces, TheLongestIdleConnectionOfTheUserGivesWay) {
  for (int i = 0; i < 16; ++i) {
    more();
    serve(seconds(1));
  }
  EXPECT_NE(ask(fds[0], request("hello")).find("\"result\""), std::string::npos) << "so it is not the longest";
  EXPECT_NE(ask(more(), request("hello")).find("\"result\""), std::string::npos);
  EXPECT_EQ(server->connections(), 16u);
  EXPECT_EQ(take(fds[1]), closed("idle for 14 s; its place was needed"));
  EXPECT_TRUE(is_closed(fds[1]));
  EXPECT_EQ(told, std::vector<std::string>{mine("idle for 14 s; its place was needed")});
  EXPECT_FALSE(is_closed(fds[0]));
}

TEST_F(DoorPlaces, AHalfLineGivesWayBeforeAnIdleConnection) {
  for (int i = 0; i < 16; ++i) more();
  serve();
  say(fds[7], "{");
  serve(seconds(2));
  more();
  serve(seconds(1));
  EXPECT_EQ(take(fds[7]), closed("a line without an end for 1 s; its place was needed"));
  EXPECT_EQ(told.size(), 1u);
}

TEST_F(DoorPlaces, AConnectionWithAPendingRequestNeverGivesWay) {
  for (int i = 0; i < 16; ++i) more();
  for (int i = 1; i < 16; ++i) say(fds[static_cast<std::size_t>(i)], request("signal", kOff));
  serve();
  say(fds[0], request("signal", kOff));  // comes in the same turn as the newcomer
  const int late = more();
  serve();
  EXPECT_EQ(backend.later.size(), 16u);
  EXPECT_EQ(take(late),
            error("null", -32002,
                  ("too many connections: the 16 of user " + std::to_string(::getuid()) + " are all in use").c_str()));
  EXPECT_TRUE(told.empty()) << "a refused connection is not reported as closed";
}

TEST_F(DoorPlaces, ASubscriberThatReadsNothingGivesWay) {
  for (int i = 0; i < 16; ++i) more();
  serve();
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}})
    ask(fds[i], request("subscribe", R"({"to":"status","period_ms":100})"));
  for (int i = 0; i < 60; ++i) {
    serve(milliseconds(100));
    EXPECT_NE(take(fds[0]), "");
    for (std::size_t other = 2; other < 16; ++other) ask(fds[other], request("hello"));
  }
  more();
  serve();
  EXPECT_FALSE(is_closed(fds[0]));
  EXPECT_NE(take(fds[1]).find("idle for 6"), std::string::npos);
  EXPECT_TRUE(is_closed(fds[1]));
  EXPECT_EQ(told.size(), 1u);
}

TEST_F(DoorPlaces, TwelveOfAUserMaySubscribe) {
  for (int i = 0; i < 13; ++i) more();
  const std::string subscribe = request("subscribe", R"({"to":"events"})");
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_NE(ask(fds[i], subscribe).find("\"subscription\""), std::string::npos) << i;
  EXPECT_EQ(ask(fds[12], subscribe),
            error("1", -32002,
                  ("too many connections: 12 of user " + std::to_string(::getuid()) + " have subscriptions").c_str()));
  EXPECT_NE(ask(fds[11], subscribe).find("\"subscription\":13"), std::string::npos) << "one more of a listener";
  ::close(fds[0]);
  fds[0] = -1;
  serve();
  EXPECT_NE(ask(fds[12], subscribe).find("\"subscription\""), std::string::npos);
}

TEST_F(DoorPlaces, FourObserversLeavePlacesForHigherRoles) {
  for (uid_t user = 61001; user <= 61004; ++user)
    for (int i = 0; i < 16; ++i) as(user, Role::kObserve);
  EXPECT_EQ(server->connections(), 32u);
  EXPECT_EQ(take(fds[0]), closed("idle for 0 ns; its place was needed"));
  EXPECT_EQ(told.size(), 32u);
  const int owner = as(::getuid(), Role::kConfigure);
  EXPECT_NE(ask(owner, request("hello")).find("\"result\""), std::string::npos);
  EXPECT_EQ(server->connections(), 33u) << "a place was kept";
}

TEST_F(DoorPlaces, AHigherRoleTakesThePlaceOfALowerOneThatOnlyListens) {
  const std::string subscribe = request("subscribe", R"({"to":"events"})");
  for (uid_t user = 1; user <= 40; ++user) ask(as(61000 + user, Role::kOperate), subscribe);
  EXPECT_EQ(server->connections(), 40u);
  EXPECT_NE(take(as(7, Role::kOperate)).find("the 40 of the roles up to operate are all in use"), std::string::npos);
  EXPECT_NE(take(as(8, Role::kObserve)).find("the 40 of the roles up to operate are all in use"), std::string::npos);
  for (uid_t user = 1; user <= 8; ++user) ask(as(62000 + user, Role::kConfigure), subscribe);
  EXPECT_TRUE(told.empty());
  EXPECT_NE(ask(as(9, Role::kConfigure), request("hello")).find("\"result\""), std::string::npos);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0],
            "a connection of user 61001 (process 4711, operate): the client had subscriptions only, and a lower role; "
            "its place was needed");
}

TEST_F(DoorPlaces, ALineThatDoesNotEndWithinFiveSecondsIsClosedInAnyCase) {
  const int slow = more(), good = more();
  serve();
  say(slow, R"({"jsonrpc")");
  const std::string text = request("hello");
  say(good, text.substr(0, 9));
  serve();
  const Nanoseconds begun = now;
  for (int i = 0; i < 4; ++i) {
    serve(seconds(1));
    say(slow, ":");  // every second a byte
  }
  EXPECT_NE(ask(good, text.substr(9)).find("\"result\""), std::string::npos);
  say(good, text + "{");
  serve();
  EXPECT_EQ(server->next_due(), begun + seconds(5));
  serve(begun + seconds(5) - now);
  EXPECT_EQ(take(slow), closed("the client sent a line without its end for 5 s"));
  EXPECT_TRUE(is_closed(slow));
  EXPECT_EQ(told, std::vector<std::string>{mine("the client sent a line without its end for 5 s")});
  serve(seconds(3));
  EXPECT_EQ(server->connections(), 1u) << "its second line began later";
  serve(seconds(2));
  EXPECT_EQ(server->connections(), 0u);
}

TEST_F(DoorPlaces, AHalfLineIsNoFaultWhileTheServerDoesNotReadIt) {
  const int fd = more();
  backend.ballast = 2'000'000;
  serve();
  say(fd, request("hello") + request("hello").substr(0, 20));
  serve();
  for (int i = 0; i < 40; ++i) {  // takes its answer slowly
    serve(milliseconds(250));
    char bytes[30'000];
    EXPECT_GT(::recv(fd, bytes, sizeof bytes, MSG_DONTWAIT), 0);
  }
  EXPECT_EQ(server->connections(), 1u);
  for (int i = 0; i < 200; ++i, serve()) take(fd);
  EXPECT_NE(ask(fd, request("hello").substr(20)).find("\"jsonrpc\""), std::string::npos);
}

TEST_F(DoorPlaces, ReportsAClientThatReadsNothingForFiveSeconds) {
  const int fd = more();
  backend.ballast = 900'000;
  serve();
  say(fd, request("hello"));
  serve();
  serve(seconds(5));
  EXPECT_EQ(told, std::vector<std::string>{mine("the client read nothing for 5 s")});
}

}  // namespace
}  // namespace chimera::control
