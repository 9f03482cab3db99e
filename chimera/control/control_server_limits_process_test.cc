// SPDX-License-Identifier: Apache-2.0
// Tests each limit of ControlServer at its exact value.
#include <poll.h>
#include <sys/resource.h>

#include <algorithm>
#include <thread>

#include "chimera/control/testing/control_server_rig.h"

namespace chimera::control {
namespace {

using DoorLimits = DoorTest;

TEST_F(DoorLimits, ClosesAfterALineThatIsTooDeep) {
  const int fd = plain();
  const std::string deep = std::string(31, '[') + std::string(31, ']');
  EXPECT_EQ(ask(fd, request("set", R"({"values":)" + deep + "}")),
            error("null", -32001, "nested deeper than 32 levels"));
  EXPECT_TRUE(is_closed(fd));
  EXPECT_EQ(server->connections(), 0u);
  ::close(fd);
}

TEST_F(DoorLimits, ClosesAfterADepthBomb) {
  const int fd = plain();
  std::thread writer([fd] {
    const std::string bytes = std::string(kMaxLine - 1, '[') + "\n";
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t n = ::send(fd, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (n <= 0) return;
      at += static_cast<std::size_t>(n);
    }
  });
  EXPECT_EQ(await_answer(fd), error("null", -32001, "nested deeper than 32 levels"));
  writer.join();
  EXPECT_TRUE(is_closed(fd));
  ::close(fd);
}

TEST_F(DoorLimits, ClosesAfterALineThatIsTooLong) {
  const int fd = plain();
  std::thread writer([fd] {
    const std::string bytes(kMaxLine + 2, ' ');
    (void)::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  });
  EXPECT_EQ(await_answer(fd), error("null", -32001, "the line is longer than 1 MiB"));
  ::shutdown(fd, SHUT_RDWR);
  writer.join();
  ::close(fd);
}

TEST_F(DoorLimits, RefusesRequestsThatComeTooFastAndAcceptsLaterOnes) {
  const int fd = plain();
  std::string flood;
  for (int i = 0; i < 300; ++i) flood += request("hello");
  const std::string got = ask(fd, flood);
  EXPECT_EQ(count(got, "\"result\""), 200u);
  EXPECT_EQ(count(got, R"({"code":-32003,"data":{"retry_ms":1},"message":"too many requests"},"id":1,)"), 100u);
  serve(milliseconds(50));
  EXPECT_EQ(count(ask(fd, flood), "\"result\""), 51u);
  serve(seconds(1));
  EXPECT_NE(ask(fd, request("hello")).find("\"result\""), std::string::npos);
  ::close(fd);
}

TEST_F(DoorLimits, ActsHaveARateOfTheirOwn) {
  const int fd = plain();
  std::string flood;
  for (int i = 0; i < 60; ++i) flood += request("flag", R"({"up":true})");
  EXPECT_EQ(count(ask(fd, flood), R"("code":-32003,"data":{"retry_ms":10})"), 10u);
  EXPECT_NE(ask(fd, request("hello")).find("\"result\""), std::string::npos);
  EXPECT_EQ(backend.calls, 51);
  ::close(fd);
}

TEST_F(DoorLimits, GarbageCountsAsRequestsAndALongLineAsSeveral) {
  const int fd = plain();
  std::string garbage;  // 50 requests are left after it, the long line needs 53
  for (int i = 0; i < 150; ++i) garbage += "?\n";
  EXPECT_EQ(count(ask(fd, garbage), "-32700"), 150u);
  const std::string spaces(52 * kLongLine, ' ');
  std::thread writer([fd, &spaces] { say(fd, spaces + request("hello", "{}", 7)); });
  const std::string got = await_answer(fd);
  writer.join();
  EXPECT_EQ(got, R"({"error":{"code":-32003,"data":{"retry_ms":3},"message":"too many requests"},"id":null,)"
                 R"("jsonrpc":"2.0"})"
                 "\n");
  EXPECT_NE(ask(fd, request("hello")).find("\"result\""), std::string::npos);
  ::close(fd);
}

TEST_F(DoorLimits, AFloodOfOnePeerDoesNotKeepAnotherWaiting) {
  const int loud = plain(), other = plain();
  std::string flood;
  for (int i = 0; i < 20000; ++i) flood += "?\n";
  say(loud, flood);
  say(other, request("hello"));
  server->serve(now = now + milliseconds(1));  // accepts
  server->serve(now);
  EXPECT_NE(take(other).find("\"result\""), std::string::npos);
  EXPECT_LE(server->next_due(), now) << "there is more to do";
  std::size_t answered = 0;
  for (int i = 0; i < 1000 && answered < 20000; ++i, answered += count(take(loud), "\"error\"")) serve();
  EXPECT_EQ(answered, 20000u);
  ::close(loud);
  ::close(other);
}

TEST_F(DoorLimits, TakesThirtyTwoSubscriptionsOfAConnection) {
  const int fd = plain();
  for (int i = 0; i < 32; ++i)
    EXPECT_NE(ask(fd, request("subscribe", R"({"to":"events"})")).find("\"result\""), std::string::npos);
  const std::string got = ask(fd, request("subscribe", R"({"to":"events"})", 33));
  EXPECT_NE(got.find(R"({"code":-32602,"data":{"where":"to"},"message":"this connection has 32 subscriptions already, )"
                     R"(and no more are allowed"},"id":33,)"),
            std::string::npos)
      << got;
  ::close(fd);
}

TEST_F(DoorLimits, ASlowReaderSkipsToTheLatestAndAStuckOneIsDropped) {
  const int fd = plain(), other = plain();
  backend.ballast = 200'000;
  ask(fd, request("subscribe", R"({"to":"values","period_ms":20})"));
  for (int i = 0; i < 2000; ++i) serve();
  EXPECT_LT(backend.pulls, 10) << "no status is made while the client does not read";
  EXPECT_EQ(server->connections(), 2u);
  EXPECT_NE(ask(other, request("hello")).find("\"result\""), std::string::npos) << "others do not notice";
  for (int i = 0; i < 400 && server->connections() == 2; ++i) serve(milliseconds(10));
  EXPECT_EQ(server->connections(), 1u);
  EXPECT_GE(now, seconds(6)) << "not before 5 s without a byte";
  EXPECT_EQ(backend.closed.size(), 1u);
  ::close(fd);
  ::close(other);
}

TEST_F(DoorLimits, AnIdleServerIsDueWhenTheTimeOfAClientEnds) {
  const int fd = plain();
  backend.ballast = 900'000;
  ask(fd, "");
  say(fd, request("hello"));
  serve();
  EXPECT_GT(server->next_due(), now);
  EXPECT_LE(server->next_due(), now + kStalledPeerLimit);
  server->serve(now = server->next_due());
  EXPECT_EQ(server->connections(), 0u);
  ::close(fd);
}

TEST_F(DoorLimits, NothingMoreIsReadFromAPeerThatDoesNotTakeItsAnswers) {
  const int fd = plain();
  backend.ballast = 600'000;
  std::string flood;
  for (int i = 0; i < 100; ++i) flood += request("hello");
  say(fd, flood);
  serve();
  EXPECT_LE(backend.calls, 5);
  std::size_t got = 0;
  for (int i = 0; i < 2000 && got < 100; ++i) {
    got += count(take(fd), "\"result\"");
    serve();
  }
  EXPECT_EQ(got, 100u) << "all of them are answered when it does";
  EXPECT_EQ(backend.calls, 100);
  ::close(fd);
}

TEST_F(DoorLimits, WithoutADescriptorLeftItWaitsAndThenGoesOn) {
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const int fd = plain();
  const rlimit none{static_cast<rlim_t>(fd) + 1, before.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &none);
  serve();
  ::setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(server->connections(), 0u);
  EXPECT_EQ(server->next_due(), now + milliseconds(100));
  pollfd one{server->descriptor(), POLLIN, 0};
  EXPECT_EQ(::poll(&one, 1, 0), 0) << "the waiting connection does not wake the owner all the time";
  serve(milliseconds(100));
  EXPECT_EQ(server->connections(), 1u);
  ::close(fd);
}

}  // namespace
}  // namespace chimera::control
