// SPDX-License-Identifier: Apache-2.0
// For tests: kills at every step of a switch.
#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "tests/stepped/stepped_subsystem.h"

namespace chimera::manager {

/// A switch from `before` to `after` during which processes are killed.
struct KillsInASwitch {
  struct Side {
    std::string configuration;
    std::string on;                              ///< as SteppedSubsystem::on() has it
    std::function<bool(SteppedSubsystem&)> sees;  ///< the readers have the values of this configuration
  };
  std::string description;  ///< starts with `before`
  Side before, after;

  /// The victims ("manager" or an rtpu) die together, at step 0, 1, 2, ... of 100 us until the switch is over first. A
  /// new subsystem for each step. Afterwards: one of the two configurations is in force, the receipt says which, the
  /// readers see its values, and the next switch works.
  void at_every_step(const std::vector<std::string>& victims) const {
    constexpr int kMostSteps = 2000;
    bool is_over = false;
    int step = 0;
    for (; !is_over && step < kMostSteps && !::testing::Test::HasFailure(); ++step) {
      SCOPED_TRACE("step " + std::to_string(step) + ", victim " + victims.back());
      is_over = at_step(step, victims);
    }
    EXPECT_LT(step, kMostSteps) << "the switch never ended";
    std::printf("%d steps with the death of %s\n", step, victims.back().c_str());
  }

 private:
  static Json request(const Side& side) { return {{"configuration", side.configuration}}; }
  bool at_step(int step, const std::vector<std::string>& victims) const {
    SteppedSubsystem system(description);
    EXPECT_TRUE(system.until([&] { return system.until_started() && system.on() == before.on; }));
    const PendingAnswer answer = system.ask("switch", request(after));
    system.run(microseconds(100) * step);
    const bool is_over = answer->has_value();
    bool is_manager_dead = false;
    for (const std::string& victim : victims) {
      if (victim == "manager") {
        is_manager_dead = true;
        system.kill_manager();
      } else {
        system.die(victim);
      }
    }
    if (is_manager_dead) {
      system.run(milliseconds(1));
      system.start_manager();
    }
    judge(system, victims, is_manager_dead ? nullptr : answer);
    return is_over;
  }
  void judge(SteppedSubsystem& system, const std::vector<std::string>& victims, const PendingAnswer& answer) const {
    for (const std::string& victim : victims) {
      if (victim == "manager") continue;
      EXPECT_TRUE(system.until([&] { return system.rtpu(victim).segment.block.head().incarnation == 2; }));
    }
    const bool is_answered = !answer || system.until([&] { return answer->has_value(); }, seconds(30));
    EXPECT_TRUE(is_answered);
    const auto is_settled = [&] {
      return (system.on() == before.on || system.on() == after.on) && system.events("hang").empty() &&
             !truth_at(system.result("status")["flag"], "up") &&
             text_at(system.result("plan", request(before)), "reason") != "under-way";
    };
    ASSERT_TRUE(system.until(is_settled)) << system.on() << system.events("switch");
    const Side& side = system.on() == after.on ? after : before;
    const Side& other = system.on() == after.on ? before : after;
    // A manager that dies before it has announced the switch leaves no receipt.
    const std::string end = after.configuration + (&side == &after ? " done\n" : " aborted\n");
    const bool may_have_none = !answer && &side == &before && system.ends().empty();
    EXPECT_EQ(system.ends(), may_have_none ? "" : end) << system.events("switch");
    EXPECT_TRUE(system.until([&] { return side.sees(system); }));
    EXPECT_EQ(system.result("switch", request(other))["end"], "done") << system.events("switch");
    EXPECT_EQ(system.on(), other.on);
    EXPECT_TRUE(system.until([&] { return other.sees(system); }));
  }
};

}  // namespace chimera::manager
