// SPDX-License-Identifier: Apache-2.0
// For tests: deaths, hangs and stray writes at every step of a switch.
#pragma once

#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "tests/stepped/stepped_subsystem.h"

namespace chimera::manager {

/// A switch from `before` to `after` with mishaps:
///   manager, RTPU    the process dies as by SIGKILL
///   SIGTERM RTPU     the process ends in order
///   service RTPU     no `init` or `kill` returns any more
///   loop RTPU        the cycling thread does nothing any more
///   page BYTE        the decision page is filled with this byte; above 255: with random bytes of this seed
struct KillsInASwitch {
  struct Side {
    std::string configuration;
    std::string on;                              ///< as SteppedSubsystem::on() has it
    std::function<bool(SteppedSubsystem&)> sees;  ///< the readers have the values of this configuration
  };
  std::string description;  ///< starts with `before`
  Side before, after;

  /// The mishaps happen together, at step 0, 1, 2, ... of 100 us until the switch is over first. A new subsystem for
  /// each step. Afterwards: one of the two configurations is in force, the receipt says which, the readers see its
  /// values, and the next switch works.
  void at_every_step(const std::vector<std::string>& mishaps) const {
    constexpr int kMostSteps = 2000;
    const int stride = is_hang(mishaps[0]) ? 7 : 1;  // it takes 12 s of the stepped clock
    bool is_over = false;
    int step = 0;
    for (; !is_over && step < kMostSteps && !::testing::Test::HasFailure(); step += stride) {
      SCOPED_TRACE("step " + std::to_string(step) + ", " + mishaps.back());
      is_over = at_step(step, mishaps);
    }
    EXPECT_LT(step, kMostSteps) << "the switch never ended";
    std::printf("%d steps with %s\n", step, mishaps.back().c_str());
  }

 private:
  static Json request(const Side& side) { return {{"configuration", side.configuration}}; }
  static bool is_a(const std::string& mishap, const char* kind) { return mishap.starts_with(kind); }
  static bool is_hang(const std::string& mishap) { return is_a(mishap, "service ") || is_a(mishap, "loop "); }
  static std::string object_of(const std::string& mishap) { return mishap.substr(mishap.rfind(' ') + 1); }
  static void befall(SteppedSubsystem& system, const std::string& mishap) {
    const std::string object = object_of(mishap);
    if (mishap == "manager") system.kill_manager();
    else if (is_a(mishap, "SIGTERM ")) system.terminate(object);
    else if (is_a(mishap, "service ")) system.hang_service(object);
    else if (is_a(mishap, "loop ")) system.end_loop(object);
    else if (is_a(mishap, "page ")) overwrite(system.decision_page(), static_cast<std::uint32_t>(std::stoul(object)));
    else system.die(mishap);
  }
  static void overwrite(DecisionPage& page, std::uint32_t with) {
    std::byte bytes[sizeof page];
    for (std::uint32_t word = with; std::byte& byte : bytes) {
      if (with > 255) word = word * 1664525u + 1013904223u;
      byte = static_cast<std::byte>(with > 255 ? word >> 24 : with);
    }
    std::memcpy(static_cast<void*>(&page), bytes, sizeof page);
  }
  bool at_step(int step, const std::vector<std::string>& mishaps) const {
    SteppedSubsystem system(description);
    EXPECT_TRUE(system.until([&] { return system.until_started() && system.on() == before.on; }));
    const PendingAnswer answer = system.ask("switch", {{"configuration", after.configuration}, {"wait_ms", 1000}});
    system.run(microseconds(100) * step);
    const bool is_over = answer->has_value();
    for (const std::string& mishap : mishaps) befall(system, mishap);
    const bool is_manager_dead = !system.has_manager();
    if (is_manager_dead) {
      system.run(milliseconds(1));
      system.start_manager();
    }
    judge(system, mishaps, is_manager_dead ? nullptr : answer);
    return is_over;
  }
  /// The switch ends an rtpu only if it waits for it.
  static void bring_back(SteppedSubsystem& system, const std::string& rtpu) {
    const auto is_back = [&] { return system.rtpu(rtpu).segment.block.head().incarnation == 2; };
    if (!is_back()) system.die(rtpu);
    EXPECT_TRUE(system.until(is_back));
    system.run(milliseconds(1));
  }
  void judge(SteppedSubsystem& system, const std::vector<std::string>& mishaps, const PendingAnswer& answer) const {
    for (const std::string& mishap : mishaps) {
      if (mishap == "manager" || is_a(mishap, "page ") || is_hang(mishap)) continue;
      EXPECT_TRUE(system.until(
          [&] { return system.rtpu(object_of(mishap)).segment.block.head().incarnation == 2; }, seconds(15)));
    }
    const bool is_answered = !answer || system.until([&] { return answer->has_value(); }, seconds(15));
    EXPECT_TRUE(is_answered);
    system.run(milliseconds(1));  // the manager knows of the restarts
    const bool may_hang = is_hang(mishaps[0]);
    if (is_a(mishaps[0], "service ")) system.hang_service(object_of(mishaps[0]), false);
    if (is_a(mishaps[0], "loop ")) bring_back(system, object_of(mishaps[0]));
    const auto is_settled = [&] {
      return (system.on() == before.on || system.on() == after.on) && (may_hang || system.events("hang").empty()) &&
             !truth_at(system.result("status")["flag"], "up") &&
             text_at(system.result("plan", request(before)), "reason") != "under-way";
    };
    ASSERT_TRUE(system.until(is_settled)) << system.on() << system.events("switch") << system.ends();
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

/// Each is tried alone. Those of a row happen together.
inline const std::vector<std::string> kMishaps[] = {
    {"first"},
    {"second"},
    {"manager"},
    {"first", "second"},
    {"first", "manager"},
    {"second", "manager"},
    {"SIGTERM first"},
    {"SIGTERM second"},
    {"SIGTERM first", "SIGTERM second"},
    {"SIGTERM first", "second"},
    {"SIGTERM first", "manager"},
    {"SIGTERM second", "manager"},
    {"loop first"},
    {"loop second"},
    {"page 0"},
    {"page 90"},
    {"page 255"},
    {"page 4711"}};

}  // namespace chimera::manager
