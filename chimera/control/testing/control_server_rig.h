// SPDX-License-Identifier: Apache-2.0
// For tests: a ControlServer on a real socket, with a clock that the test steps and a backend of the test.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/control/control_server.h"

namespace chimera::control {

/// Echoes; keeps the replies of `signal` in `later`, drops the reply of `library`.
struct FakeBackend final : ControlBackend {
  void call(const MethodRule& method, const Json& parameters, const Caller& caller, Reply reply) override;
  RpcResponse open(std::uint64_t subscription, const Json& parameters) override;
  void close(std::uint64_t subscription) override { closed.push_back(subscription); }
  void forget(std::uint64_t connection) override { forgotten.push_back(connection); }
  std::shared_ptr<const Json> pull(std::uint64_t subscription) override;

  std::vector<Reply> later;
  std::vector<std::uint64_t> opened, closed, forgotten;
  std::vector<std::string> called;  ///< methods, in the order in which they came
  int busy_us = 0;                  ///< that a call for `status` takes
  int calls = 0, pulls = 0, news = 1'000'000;
  std::size_t ballast = 0;
};

struct DoorTest : ::testing::Test {
  void SetUp() override {
    char made[] = "/tmp/chimera-server-XXXXXX";
    folder = ::mkdtemp(made);
    path = folder + "/subject.sock";
    open_door();
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  /// As when the manager is started again: the socket stays when the keeper holds it.
  void open_door() {
    if (listening < 0) {
      listening = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
      const sockaddr_un address = address_of(path);
      ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
      ASSERT_EQ(::listen(listening, 64), 0);
    }
    server = *ControlServer::open(::dup(listening), backend, ::getuid(), groups);
  }
  static sockaddr_un address_of(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.c_str(), path.size());
    return address;
  }
  /// A connection that knows no protocol; -1: refused.
  static int plain_to(const std::string& path) {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_un address = address_of(path);
    return ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? fd : -1;
  }
  int plain() { return plain_to(path); }

  /// Serves once, and again as long as ControlServer has more to do at the same instant.
  void serve(Nanoseconds step = milliseconds(1)) {
    server->serve(now = now + step);
    for (int i = 0; i < 1000 && server->next_due() <= now; ++i) server->serve(now);
  }
  static void say(int fd, const std::string& text) {
    EXPECT_EQ(::send(fd, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  /// Sends, serves, and takes what comes back.
  std::string ask(int fd, const std::string& text) {
    say(fd, text);
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
  /// Serves at one instant until something comes back from what another thread sends.
  std::string await_answer(int fd) {
    std::string got;
    EXPECT_TRUE(await_that([&] {
      serve(Nanoseconds{});
      got = take(fd);
      return !got.empty();
    }));
    return got;
  }
  static bool is_closed(int fd) {
    char byte;
    return ::recv(fd, &byte, 1, MSG_DONTWAIT) == 0;
  }
  static std::string request(const std::string& method, const std::string& parameters = "{}", int id = 1) {
    return R"({"jsonrpc":"2.0","id":)" + std::to_string(id) + R"(,"method":")" + method + R"(","params":)" +
           parameters + "}\n";
  }
  static std::string error(const char* id, int code, const char* message) {
    return R"({"error":{"code":)" + std::to_string(code) + R"(,"message":")" + message + R"("},"id":)" + id +
           R"(,"jsonrpc":"2.0"})" + "\n";
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
    return n;
  }

  std::string folder, path;
  int listening = -1;
  RoleGroups groups;
  FakeBackend backend;
  std::unique_ptr<ControlServer> server;
  Nanoseconds now = seconds(1);
};

}  // namespace chimera::control
