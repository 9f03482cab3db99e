// SPDX-License-Identifier: Apache-2.0
// The program chimera-manager, killed at any moment; the test plays the keeper and the rtpus.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <random>

#include "chimera/base/testing/await.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/control/client.h"
#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

const char* program() {
  static const std::string kProgram = build_path("bin/chimera-manager");
  return kProgram.c_str();
}

/// A listening socket in a folder of its own.
class Listening {
 public:
  Listening() {
    EXPECT_NE(::mkdtemp(folder_), nullptr);
    path_ = std::string(folder_) + "/fake.sock";
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    descriptor_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    EXPECT_EQ(::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(descriptor_, 16), 0);
  }
  ~Listening() {
    ::close(descriptor_);
    ::unlink(path_.c_str());
    ::rmdir(folder_);
  }
  Listening(const Listening&) = delete;
  int descriptor() const noexcept { return descriptor_; }
  const std::string& path() const noexcept { return path_; }

 private:
  char folder_[32] = "/tmp/chimera_manager_XXXXXX";
  std::string path_;
  int descriptor_ = -1;
};

/// The keeper's loop: starts the manager again after each death.
class Kept {
 public:
  Kept() : manager_(fake_.start_program(program(), listening_.descriptor())), thread_([this] { run(); }) {}
  ~Kept() {
    stop_ = true;
    thread_.join();
    manager_.signal(SIGKILL);
    ProcessEnd end;
    manager_.wait(end, kHangLimit.count);
  }
  void kill_next() { wants_death_ = true; }
  std::uint32_t starts() const noexcept { return starts_; }
  const std::string& path() const noexcept { return listening_.path(); }
  FakeSubsystem& fake() noexcept { return fake_; }

 private:
  void run() {
    while (!stop_) {
      fake_.keep();
      if (wants_death_.exchange(false)) manager_.signal(SIGKILL);
      ProcessEnd end;
      if (manager_.has_ended(end)) {
        fake_.keep();  // its last words
        ++starts_;  // before the start: the new manager may answer at once
        manager_ = fake_.start_program(program(), listening_.descriptor());
      }
      ::usleep(200);
    }
  }

  Listening listening_;
  FakeSubsystem fake_;
  Process manager_;
  std::atomic<bool> stop_{false}, wants_death_{false};
  std::atomic<std::uint32_t> starts_{1};
  std::thread thread_;
};

/// Asks again on a new connection while managers die under it.
Json ask(const std::string& path, const char* method, const Json& parameters = Json::object()) {
  for (int tries = 0; tries < 20; ++tries) {
    auto client = control::Client::connect_to(path, kHangLimit);
    if (!client) continue;
    const control::RpcResponse answer = client->call(method, parameters, kHangLimit);
    if (answer.is_good()) return *answer.result;
    EXPECT_EQ(answer.code, control::kNoConnection) << method << ": " << answer.message;
  }
  ADD_FAILURE() << method << " was never answered";
  return {};
}

TEST(ManagerProcess, KilledAtAnyMomentItForgetsNothing) {
  Kept kept;
  std::mt19937 random(1);
  std::uint64_t last_event = 0;
  for (int round = 1; round <= 15; ++round) {
    Json answer = ask(kept.path(), "set", {{"values", {{"kp", Json::array({round, -round})}}}});
    ::usleep(std::uniform_int_distribution<useconds_t>(0, 60'000)(random));
    kept.kill_next();
    EXPECT_EQ(ask(kept.path(), "get", {{"variables", {"kp"}}})["values"]["kp"]["value"], Json::array({round, -round}));
    const std::uint64_t last = ask(kept.path(), "events")["last"].as_uint64();
    EXPECT_GT(last, last_event);
    last_event = last;
  }
  const Json status = ask(kept.path(), "status");
  for (const Json& task : status["tasks"]) {
    EXPECT_EQ(task["state"], "ON");
    EXPECT_EQ(task["incarnation"], 1);
  }
  EXPECT_GT(kept.starts(), 10u);
  const auto told = [&] { return ask(kept.path(), "hello")["manager"]["starts"].as_uint64(); };
  EXPECT_TRUE(await_that([&] { return told() == kept.starts(); }))
      << "the last may have been killed between its answer and the check";
}

TEST(ManagerProcess, ACommandWaitsForTheRestartedManager) {
  Kept kept;
  (void)ask(kept.path(), "hello");
  kept.kill_next();
  ASSERT_TRUE(await_that([&] { return kept.starts() > 1; }));
  auto client = control::Client::connect_to(kept.path());
  ASSERT_TRUE(client);
  const control::RpcResponse answer = client->call("signal", {{"signal", "off"}, {"tasks", {"law"}}});
  EXPECT_TRUE(answer.is_good()) << answer.message;
}

TEST(ManagerProcess, EndsWithItsKeeperAndRefusesToRunWithoutOne) {
  const Listening listening;
  FakeSubsystem fake;
  Process manager = fake.start_program(program(), listening.descriptor());
  fake.kill_manager();  // the keeper's end of the channel is closed
  ProcessEnd end;
  ASSERT_TRUE(manager.wait(end, kHangLimit.count));
  EXPECT_EQ(end.code, 0);
  EXPECT_FALSE(end.by_signal);
  const char* const words[] = {program()};
  auto alone = Process::start(program(), words, {});
  ASSERT_TRUE(alone);
  ASSERT_TRUE(alone->wait(end, kHangLimit.count));
  EXPECT_EQ(end.code, 2);
}

}  // namespace
}  // namespace chimera::manager
