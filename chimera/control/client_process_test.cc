// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/client.h"

#include <poll.h>

#include <atomic>
#include <functional>
#include <thread>

#include "chimera/control/running.h"
#include "chimera/control/testing/control_server_rig.h"
#include "chimera/platform/socket_place.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

/// Runs ControlServer in a thread until stop().
struct ClientTest : DoorTest {
  void start() {
    done = false;
    serving = std::thread([this] {
      while (!done) {
        pollfd one{server->descriptor(), POLLIN, 0};
        ::poll(&one, 1, 5);
        server->serve(now = now + milliseconds(5));
      }
    });
  }
  void stop() {
    done = true;
    if (serving.joinable()) serving.join();
  }
  void TearDown() override {
    stop();
    DoorTest::TearDown();
  }
  std::thread serving;
  std::atomic<bool> done = false;
};

TEST_F(ClientTest, CallsAndHearsNotifications) {
  start();
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client);
  const RpcResponse hello = client->call("hello");
  ASSERT_TRUE(hello.is_good()) << hello.message;
  EXPECT_EQ((*hello.result)["role"], "configure");
  const RpcResponse wrong = client->call("helo");
  EXPECT_EQ(wrong.code, kNoMethod);
  EXPECT_EQ(wrong.detail("nearest"), "hello");
  ASSERT_TRUE(client->call("subscribe", {{"to", "status"}, {"period_ms", 20}}).is_good());
  const auto note = client->next(kHangLimit);
  ASSERT_TRUE(note && *note);
  EXPECT_EQ((*note)->method, "status");
  EXPECT_EQ(client->call("signal", {{"signal", "off"}, {"tasks", {"a"}}}, milliseconds(50)).code, kNoAnswer);
}

TEST_F(ClientTest, WaitsForAManagerThatIsBeingRestarted) {
  auto client = Client::connect_to(path);  // the keeper holds the socket: a new manager will serve it
  ASSERT_TRUE(client);
  std::thread later([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    start();
  });
  EXPECT_TRUE(client->call("hello").is_good());
  later.join();
}

TEST_F(ClientTest, AsksAgainWhenTheManagerDiedAndMayHaveActedOnlyWhereItDoesNotMatter) {
  start();
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client && client->call("hello").is_good());
  stop();
  open_door();  // the former one and its connections are gone
  start();
  EXPECT_TRUE(client->call("status").is_good()) << "the line was never read";
  EXPECT_TRUE(client->call("flag", {{"up", true}}).is_good());
  stop();
  open_door();
  start();
  EXPECT_TRUE(client->call("flag", {{"up", true}}).is_good()) << "the line was never read";
  const auto die = [this] {
    EXPECT_TRUE(await_that([this] { return !backend.later.empty(); }));
    stop();
    open_door();
    start();
  };
  std::thread killer(die);
  const RpcResponse lost = client->call("signal", {{"signal", "off"}, {"tasks", {"a"}}});
  killer.join();
  EXPECT_EQ(lost.code, kNoConnection);
  EXPECT_EQ(lost.message, "the manager ended before it answered; `chimera status` says what was done");
}

TEST_F(ClientTest, DoesNotHideThatSubscriptionsAreLost) {
  start();
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client && client->call("subscribe", {{"to", "events"}}).is_good());
  stop();
  open_door();
  start();
  EXPECT_EQ(client->call("status").message, "the connection to the subsystem was lost");
  EXPECT_TRUE(client->call("status").is_good()) << "the loss was reported once";
}

TEST_F(ClientTest, ConnectsAnewAfterItsSubscriptionsWereLostOrDropped) {
  start();
  Client client = Client::at(path);
  EXPECT_FALSE(client.is_connected()) << "not before the first call";
  ASSERT_TRUE(client.call("subscribe", {{"to", "events"}}).is_good());
  stop();
  open_door();
  start();
  for (;;) {
    const auto note = client.next(kHangLimit);
    if (!note) break;
    ASSERT_TRUE(*note) << "neither a notification nor a loss";
  }
  EXPECT_FALSE(client.is_connected());
  EXPECT_TRUE(client.call("subscribe", {{"to", "events"}}).is_good());
  client.drop();
  EXPECT_FALSE(client.is_connected());
  EXPECT_TRUE(client.call("status").is_good());
  EXPECT_FALSE(*client.next(milliseconds(50))) << "of a subscription that was dropped nothing comes";
  EXPECT_EQ(Client::at(folder + "/absent.sock").call("status").code, kNoConnection);
}

/// Reads a line of each connection: of the first it closes without an answer, of the second it answers.
struct HalfDeafServer {
  explicit HalfDeafServer(int listening) : listening_(listening), thread_([this] { serve(); }) {}
  /// How often the line came.
  int end() {
    is_over_ = true;
    thread_.join();
    return lines_;
  }

 private:
  void serve() {
    while (!is_over_) {
      pollfd one{listening_, POLLIN, 0};
      if (::poll(&one, 1, 5) <= 0) continue;
      const OwnedDescriptor peer(::accept(listening_, nullptr, nullptr));
      std::string line;
      for (char byte = 0; byte != '\n' && ::recv(peer.fd, &byte, 1, 0) == 1;) line += byte;
      const Json request = Json::parse_or_none(line).value_or(nullptr);
      if (!request.contains("id") || ++lines_ == 1) continue;
      const std::string answer = Json{{"id", request["id"]}, {"result", Json::object()}}.dump() + "\n";
      (void)::send(peer.fd, answer.data(), answer.size(), MSG_NOSIGNAL);
      char byte;
      (void)::recv(peer.fd, &byte, 1, 0);  // until the client has taken it and goes
    }
  }

  int listening_;
  std::atomic<int> lines_ = 0;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

TEST_F(ClientTest, SendsAnActOnceAndAQuestionAgainWhenTheConnectionIsLost) {
  server.reset();
  for (const MethodRule& rule : methods()) {
    HalfDeafServer half_deaf(listening);
    RpcResponse answer;
    {
      Client client = Client::at(path);
      answer = client.call(rule.name, Json::object());
    }
    EXPECT_EQ(half_deaf.end(), rule.is_act ? 1 : 2) << rule.name;
    EXPECT_EQ(answer.code, rule.is_act ? kNoConnection : 0) << rule.name << ": " << answer.message;
    const char* words = rule.is_act ? "the manager ended before it answered; `chimera status` says what was done" : "";
    EXPECT_EQ(answer.message, words) << rule.name;
  }
}

TEST_F(ClientTest, HearsWhyItIsNotLetInAndGetsInAsSoonAsThereIsAPlace) {
  start();
  std::vector<int> fds;
  for (int i = 0; i < 16; ++i) say(fds.emplace_back(plain()), request("signal", R"({"signal":"off","tasks":["a"]})"));
  EXPECT_TRUE(await_that([this] { return backend.later.size() >= 16; }));
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));  // refused before it says a word
  RpcResponse refused;
  EXPECT_TRUE(await_that([&] {  // kNoAnswer: the server was held up at the last try of the call
    refused = client->call("hello", Json::object(), milliseconds(200));
    return refused.code != kNoAnswer;
  }));
  EXPECT_EQ(refused.code, kTooMany);
  EXPECT_EQ(refused.message, "too many connections: the 16 of user " + std::to_string(::getuid()) + " are all in use");
  std::thread later([fd = fds[3]] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ::close(fd);
  });
  EXPECT_TRUE(client->call("hello").is_good());
  later.join();
  for (const int fd : fds) ::close(fd);
}

TEST_F(ClientTest, ReconnectsAndSendsAnActAfterItGaveWay) {
  start();
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client && client->call("hello").is_good());
  std::vector<int> fds;
  for (int i = 0; i < 16; ++i) fds.push_back(plain());
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_TRUE(client->call("flag", {{"up", true}}).is_good());
  for (const int fd : fds) ::close(fd);
}

struct LimitTest : ClientTest {
  Nanoseconds took(const std::function<void()>& call) {
    const auto begun = std::chrono::steady_clock::now();
    call();
    return {std::chrono::nanoseconds(std::chrono::steady_clock::now() - begun).count()};
  }
  const std::string silent =
      "the manager of 'subject' does not answer for 200 ms; its rtpus go on without "
      "it; try again, or tell the user who started it";
};

TEST_F(LimitTest, HoldsForAConnectionThatIsNotAccepted) {
  std::vector<int> fds;  // no server accepts them: the queue fills
  for (int i = 0; i < 1000; ++i) {
    fds.push_back(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const sockaddr_un address = address_of(path);
    if (::connect(fds.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) break;
  }
  const Nanoseconds time = took([&] {
    const auto client = Client::connect_to(path, milliseconds(200));
    ASSERT_FALSE(client);
    EXPECT_EQ(client.error().message.view(), silent);
  });
  EXPECT_GE(time, milliseconds(190));
  record_duration("until_refused", time);
  std::thread later([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    start();
  });
  EXPECT_TRUE(Client::connect_to(path)) << "in turn, when a server accepts them";
  later.join();
  for (const int fd : fds) ::close(fd);
}

TEST_F(LimitTest, HoldsForACallThatIsNotAnswered) {
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client);
  const RpcResponse late = client->call("hello", Json::object(), milliseconds(200));
  EXPECT_EQ(late.code, kNoAnswer);
  EXPECT_EQ(late.message, silent);
}

TEST_F(LimitTest, ALongOneIsWaitedForAsLongAsTheManagerShowsASignOfLife) {
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client);
  const Json off{{"signal", "spawn"}, {"tasks", {"a"}}};
  EXPECT_EQ(client->call("signal", off, kHangLimit, milliseconds(200)).message, silent);
  start();
  const Nanoseconds time = took([&] {
    const RpcResponse late = client->call("signal", off, seconds(2), milliseconds(1500));
    EXPECT_EQ(late.code, kNoAnswer);
    EXPECT_EQ(late.message, "no answer within 2 s; `chimera status` says what was done");
  });
  EXPECT_GE(time, milliseconds(1990));
  EXPECT_TRUE(client->call("hello").is_good()) << "the client skips the late answer";
}

TEST_F(ClientTest, AMalformedAnswerDoesNotEndTheClient) {
  auto client = Client::connect_to(path);
  ASSERT_TRUE(client);
  const int other = ::accept(listening, nullptr, nullptr);
  for (const char* line : {R"({"id":1,"error":7})", R"({"id":2,"error":{"code":"x","message":1}})",
                           R"({"id":3,"error":{"code":-32000,"message":"no","data":[]}})", R"({"id":4})"})
    say(other, std::string("garbage\n[]\n7\n{\"id\":99}\n{\"method\":\"m\",\"params\":5}\n") + line + "\n");
  EXPECT_EQ(client->call("hello").message, "the other end does not speak the control protocol");
  EXPECT_EQ(client->call("hello").code, kNoConnection);
  EXPECT_EQ(client->call("hello").message, "no");
  EXPECT_TRUE(client->call("hello").is_good());
  const auto note = client->next(Nanoseconds{});
  ASSERT_TRUE(note && *note);
  EXPECT_EQ(*(*note)->parameters, 5);
  ::close(other);
}

struct FindTest : DoorTest {
  void SetUp() override {
    DoorTest::SetUp();
    ::setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
    ::unsetenv("CHIMERA_SUBSYSTEM");
  }
  void TearDown() override {
    ::unsetenv("XDG_RUNTIME_DIR");
    ::unsetenv("CHIMERA_SUBSYSTEM");
    DoorTest::TearDown();
  }
  void place(const char* name) {
    std::filesystem::create_directory(folder + "/chimera");
    std::filesystem::permissions(folder + "/chimera", std::filesystem::perms::owner_all);
    std::filesystem::rename(path, socket_path(folder + "/chimera", name));
  }
  static std::string said(const std::string& name) {
    const auto found = Client::connect(name);
    return found ? found->path().substr(found->path().rfind('/') + 1) : std::string(found.error().message.view());
  }
};

TEST_F(FindTest, WithoutASubsystemItSaysHowToStartOne) {
  EXPECT_EQ(said(""), "no subsystem runs; start one with `chimera run FILE`");
  EXPECT_EQ(said("arm"), "no subsystem 'arm' runs; start one with `chimera run FILE`");
}

TEST_F(FindTest, TheOnlySubsystemNeedsNoName) {
  place("subject");
  EXPECT_EQ(running_subsystems(folder + "/chimera"), std::vector<std::string>{"subject"});
  EXPECT_EQ(said(""), "subject.sock");
  EXPECT_EQ(said("subject"), "subject.sock");
  EXPECT_EQ(said("subjetc"), "no subsystem 'subjetc' runs; did you mean 'subject'?");
  EXPECT_EQ(said("arm"), "no subsystem 'arm' runs; these run: subject");
  EXPECT_EQ(said(folder + "/chimera/subject.sock"), "subject.sock");
  EXPECT_EQ(said(folder + "/chimera/other.sock"), "no subsystem listens here");
}

TEST_F(FindTest, TheServicesOfTheMachineAreLookedAtWhenNoneOfOnesOwnFits) {
  const std::string mine = folder + "/mine", services = folder + "/chimera";
  std::filesystem::create_directory(mine);
  EXPECT_EQ(folder_with("", mine, services), mine);
  place("subject");
  EXPECT_EQ(folder_with("", mine, services), services);
  EXPECT_EQ(folder_with("subject", mine, services), services);
  EXPECT_EQ(folder_with("arm", mine, services), mine);
  EXPECT_EQ(folder_with("", services, mine), services);
}

TEST_F(FindTest, AmongSeveralOneMustBeNamed) {
  place("subject");
  listening = -1;
  open_door();
  place("arm");
  EXPECT_EQ(said(""), "several subsystems run: arm, subject; say --subsystem NAME");
  ::setenv("CHIMERA_SUBSYSTEM", "arm", 1);
  EXPECT_EQ(said(""), "arm.sock");
  EXPECT_EQ(said("subject"), "subject.sock");
}

TEST_F(FindTest, IgnoresASocketWithoutAListener) {
  place("subject");
  server.reset();
  ::close(listening);
  EXPECT_EQ(said(""), "no subsystem runs; start one with `chimera run FILE`");
}

TEST_F(FindTest, AFolderThatOthersMayWriteToIsNotTrusted) {
  place("subject");
  std::filesystem::permissions(folder + "/chimera", std::filesystem::perms::all);
  EXPECT_EQ(said(""), "others may write to the folder of the sockets");
}

}  // namespace
}  // namespace chimera::control
