// SPDX-License-Identifier: Apache-2.0
// Slow switches over two rtpus, each of which cycles in its own thread in real time; also under the thread sanitizer.
// The thread of the test plays the manager.
#include "chimera/rtpu/switch_links.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/rtpu/testing/test_rtpus.h"
#include "chimera/runtime/testing/tool_scene.h"

namespace chimera {
namespace {

using namespace testing::tool_scene;
using testing::TestRtpus;

/// Lets the rtpus cycle. The thread of each steps its clock to the elapsed time.
class CyclingRtpus {
 public:
  explicit CyclingRtpus(TestRtpus& rtpus) : rtpus_(rtpus), origin_(rtpus.now) {
    for (std::uint32_t u = 0; u < rtpus.n; ++u) threads_.emplace_back([this, u] { cycle(u); });
  }
  ~CyclingRtpus() {
    ends_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

  /// Sets the manager's time to now.
  void follow() { rtpus_.now = now(); }

 private:
  static constexpr std::chrono::microseconds kLook{20};

  Nanoseconds now() const {
    const auto passed = std::chrono::steady_clock::now() - began_;
    return origin_ + Nanoseconds{std::chrono::duration_cast<std::chrono::nanoseconds>(passed).count()};
  }
  void cycle(std::uint32_t u) {
    for (; !ends_; std::this_thread::sleep_for(kLook))
      (void)rtpus_.rtpus[u]->executive->run(now() - rtpus_.keeper.origin);
  }

  TestRtpus& rtpus_;
  const Nanoseconds origin_;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::atomic<bool> ends_{false};
  std::vector<std::thread> threads_;
};

struct SwitchLinksThreads : ::testing::Test {
  SwitchLinksThreads() {
    shop = {};
    rtpus.run(milliseconds(1));
    for (const TaskId task : {kLight, kHeavy, kArm, kLaw}) {
      rtpus.send(Signal::kSpawn, {task});
      rtpus.run(milliseconds(1));
    }
    for (const TaskId task : kSets[kWithLight]) rtpus.send(Signal::kOn, {task});
    rtpus.run(milliseconds(10));
    EXPECT_TRUE(are_on(kWithLight));
    EXPECT_FALSE(rtpus.flag_is_up());
    shop = {};
  }
  State state(TaskId task) const { return rtpus.rtpus[app->tasks[task.index].rtpu.index]->state(task); }
  bool are_on(std::uint32_t set) const {
    const auto& tasks = kSets[set];
    return std::ranges::all_of(std::vector{kLight, kHeavy, kArm, kLaw}, [&](TaskId task) {
      return (state(task) == State::kOn) == (std::ranges::count(tasks, task) != 0);
    });
  }
  /// Both tools produce `grip`: while one goes ON, the other is never shown as ON.
  void watch_producers() {
    shop.in_step = [this](const std::string& what) {
      EXPECT_TRUE(what != "on heavy" || state(kLight) != State::kOn);
      EXPECT_TRUE(what != "on light" || state(kHeavy) != State::kOn);
      EXPECT_TRUE(rtpus.flag_is_up()) << what;
    };
  }
  void expect_done(std::uint32_t to) {
    const std::string tool = to == kWithHeavy ? "heavy" : "light", other = to == kWithHeavy ? "light" : "heavy";
    EXPECT_EQ(shop.story, (std::vector<std::string>{"off " + other, "reinit arm", "reinit law", "on " + tool}));
    for (std::uint32_t u = 0; u < 2; ++u) {
      EXPECT_EQ(rtpus.part(u).end, SwitchEnd::kDone) << static_cast<int>(rtpus.part(u).why);
      EXPECT_EQ(rtpus.part(u).n_reinitialised, 1u);
    }
    EXPECT_EQ(rtpus.part(0).at, rtpus.part(1).at);
    EXPECT_EQ(rtpus.part(0).reinitialised[0], kArm);
    EXPECT_EQ(rtpus.part(1).reinitialised[0], kLaw);
    EXPECT_GE(rtpus.part(0).flag, milliseconds(1)) << "the arm has acted on it";
  }
  /// `on` of the tool of `to` failed: this tool is in ERROR, and the other one is ON again.
  void expect_taken_back(std::uint32_t to) {
    const std::string tool = to == kWithHeavy ? "heavy" : "light", other = to == kWithHeavy ? "light" : "heavy";
    EXPECT_EQ(shop.story, (std::vector<std::string>{"off " + other, "reinit arm", "reinit law", "on " + tool,
                                                    "reinit arm", "reinit law", "on " + other}));
    const std::uint32_t owner = to == kWithHeavy ? 1 : 0;
    EXPECT_EQ(rtpus.part(owner).why, NoSwitch::kOnFailed);
    EXPECT_EQ(rtpus.part(owner).task, to == kWithHeavy ? kHeavy : kLight);
    EXPECT_STREQ(rtpus.part(owner).said, "no");
    EXPECT_EQ(rtpus.part(1 - owner).why, NoSwitch::kNone);
    for (std::uint32_t u = 0; u < 2; ++u) {
      EXPECT_EQ(rtpus.part(u).end, SwitchEnd::kAborted);
      EXPECT_FALSE(rtpus.part(u).not_back.is_valid());
    }
    EXPECT_EQ(state(to == kWithHeavy ? kHeavy : kLight), State::kError);
  }
  void clear(TaskId task) {
    rtpus.send(Signal::kClear, {task});
    ASSERT_TRUE(await_that([&] { return state(task) == State::kOff; }));
  }

  std::unique_ptr<testing::TestApplication> app = testing::tool_scene::application(0);
  TestRtpus rtpus{*app};
};

TEST_F(SwitchLinksThreads, SlowSwitchesThereAndBackLeaveOneProducerAndNoFlag) {
  constexpr int kSwitches = 300;
  std::uint32_t in_force = kWithLight;
  {
    CyclingRtpus cycling(rtpus);
    watch_producers();
    for (int i = 0; i < kSwitches && !HasFailure(); ++i) {
      const std::uint32_t to = in_force == kWithLight ? kWithHeavy : kWithLight;
      const bool fails = i % 9 == 4;
      shop.story.clear();
      shop.fails = !fails ? "" : to == kWithHeavy ? "on heavy" : "on light";
      cycling.follow();
      const std::uint16_t number = rtpus.switch_to(to, microseconds(300), kHangLimit, kSlowForConstants);
      ASSERT_TRUE(await_that([&] { return rtpus.is_over(number); })) << i;
      fails ? expect_taken_back(to) : expect_done(to);
      if (!fails) in_force = to;
      else clear(to == kWithHeavy ? kHeavy : kLight);
      EXPECT_TRUE(are_on(in_force)) << i;
      EXPECT_FALSE(rtpus.flag_is_up()) << i;
      EXPECT_EQ(rtpus.part(0).number, number);
    }
  }
  EXPECT_EQ(shop.weighed.back(), in_force == kWithHeavy ? 3 : 1);
  EXPECT_GT(std::ranges::count(shop.weighed, 1.0), 0);
  EXPECT_GT(std::ranges::count(shop.weighed, 3.0), 0);
  EXPECT_GT(shop.illegal, kSwitches / 2) << "the arm has seen the flag";
}

}  // namespace
}  // namespace chimera
