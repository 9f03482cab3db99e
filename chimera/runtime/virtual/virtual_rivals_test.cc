// SPDX-License-Identifier: Apache-2.0
// Two tasks on two rtpus that open one device, in virtual time: never both have it, also when an rtpu dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "chimera/runtime/testing/virtual_scene.h"

namespace chimera::virtual_rivals_test {
namespace {

using testing::act_at;
using testing::VirtualScene;

/// The device, which a process that dies closes. One run at a time.
struct Device {
  bool is_open[4] = {};  // of the hand, the drill, and the same of a second device
  const VirtualPeers* peers = nullptr;
  int doubles = 0;             // times that one opened it while another had it
  int not_ready = 0;
  std::uint64_t fails_at = UINT64_MAX;  // the cycle of the hand

  bool has_other(int me) const {
    const int other = me ^ 1;
    return is_open[other] && peers->presence(TaskId(std::size_t(other < 2 ? other : other + 1))).lives;
  }
};
Device device;

template <int kMe>
struct Tool {
  Out<double> force{"force", "N", initial = 0.0};
  Resource port{"port"};
  Outcome init(Cycle c) {
    device.doubles += device.has_other(kMe) ? 1 : 0;
    device.is_open[kMe] = true;
    c.spend(microseconds(300));
    return ok();
  }
  Outcome on(Cycle) {
    return kMe == 1 && device.not_ready-- > 0 ? not_yet() : ok();
  }
  Outcome cycle(Cycle c) {
    *force = kMe + 1;
    return kMe % 2 == 0 && c.count() == device.fails_at ? fault("no current") : ok();
  }
  void kill(Cycle c) {
    c.spend(microseconds(200));
    device.is_open[kMe] = false;
  }
};

struct Arm {
  In<double> force{"force", "N"};
  Out<double> u{"u", "N", initial = 0.0};
  void cycle(Cycle) { *u = *force; }
};

constexpr TaskId kHand{0u}, kDrill{1u}, kArm{2u}, kSecondHand{3u}, kSecondDrill{4u};

constexpr std::uint32_t kOfHand = 0, kOfDrill = 1, kWithHand = 0, kWithDrill = 1;

struct VirtualRivals : ::testing::TestWithParam<bool> {
  /// Runs for `duration` with these acts. Returns the receipts.
  std::span<const SwitchReceipt> go(Nanoseconds duration, std::vector<ScriptAct> acts) {
    const std::uint64_t fails_at = device.fails_at;
    device = {};
    device.fails_at = fails_at;
    device.not_ready = 2;
    std::ranges::stable_sort(acts, {}, &ScriptAct::at);
    auto app = std::make_unique<testing::TestApplication>();
    app->rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app->add("hand", testing::component<Tool<0>>("hand")).rtpu = RtpuId(kOfHand);
    app->add("drill", testing::component<Tool<1>>("drill")).rtpu = RtpuId(kOfDrill);
    app->add("arm", testing::component<Arm>("arm")).rtpu = RtpuId(kOfDrill);
    for (const TaskId tool : {kHand, kDrill}) app->port(tool.index, 1).value = tty;
    if (has_second) {
      app->add("second_hand", testing::component<Tool<2>>("second_hand")).rtpu = RtpuId(kOfHand);
      app->add("second_drill", testing::component<Tool<3>>("second_drill")).rtpu = RtpuId(kOfDrill);
      for (const TaskId tool : {kSecondHand, kSecondDrill}) {
        app->port(tool.index, 1).value = second_tty;
        app->link(tool.index, 0, "second_force");
      }
    }
    app->make(hand, false);
    app->spec.sets = named;
    app->spec.standbys = standbys;
    rtpus.reset();
    rtpus = std::make_unique<VirtualScene>(std::move(app), std::move(acts), GetParam());
    device.peers = &rtpus->peers();
    rtpus->run(duration);
    return rtpus->receipts();
  }
  State state(TaskId task) const { return rtpus->state(task); }
  void TearDown() override { rtpus.reset(); }

  bool has_second = false;
  const std::vector<std::byte> tty = testing::bytes_of("tty0"), second_tty = testing::bytes_of("tty1");
  std::vector<TaskId> hand{kHand, kArm}, drill{kDrill, kArm};
  NamedSet named[2] = {{"hand", hand}, {"drill", drill}};
  std::vector<StandbySpec> standbys;
  std::unique_ptr<VirtualScene> rtpus;
};

INSTANTIATE_TEST_SUITE_P(All, VirtualRivals, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "Preemptive" : "Executive"; });

// The rtpu of the hand dies at 60 instants from before the switch to after it.
TEST_P(VirtualRivals, ADeathAtAnyInstantLeavesOneUserAtMost) {
  int done = 0, aborted = 0;
  for (int i = 0; i < 60; ++i) {
    const Nanoseconds death = milliseconds(4) + Nanoseconds{151'000 * i};
    const auto receipts = go(milliseconds(60), {act_at(milliseconds(5), ScriptAct::Kind::kSwitch, kWithDrill),
                                                act_at(death, ScriptAct::Kind::kDie, kOfHand)});
    EXPECT_EQ(device.doubles, 0) << i;
    for (const SwitchReceipt& receipt : receipts) {
      done += receipt.end == SwitchEnd::kDone ? 1 : 0;
      aborted += receipt.end == SwitchEnd::kAborted ? 1 : 0;
      EXPECT_EQ(state(kDrill), receipt.end == SwitchEnd::kDone ? State::kOn : State::kNotCreated) << i;
    }
  }
  EXPECT_GT(done, 5);
  EXPECT_GT(aborted, 5);
}

// Both wait until the other rtpu has seen them in ERROR, each for itself.
TEST_P(VirtualRivals, TwoPrimariesMayFailAtOnce) {
  has_second = true;
  hand.push_back(kSecondHand);
  named[kWithHand].order = hand;
  standbys = {{kHand, kDrill}, {kSecondHand, kSecondDrill}};
  device.fails_at = 20;
  go(milliseconds(60), {});
  device.fails_at = UINT64_MAX;
  EXPECT_EQ(state(kHand), State::kNotCreated);
  EXPECT_EQ(state(kSecondHand), State::kNotCreated);
  EXPECT_EQ(state(kDrill), State::kOn);
  EXPECT_EQ(state(kSecondDrill), State::kOn);
  EXPECT_EQ(device.doubles, 0);
}

}  // namespace
}  // namespace chimera::virtual_rivals_test
