// SPDX-License-Identifier: Apache-2.0
// Signal components do not allocate in on, cycle and off. A hook counts allocations, and a test shows that it counts.
#include <gtest/gtest.h>

#include <cstdlib>

#include "library/signals/testing/signal_rig.h"

// From the address sanitizer, with which the tests of the library are built; <sanitizer/allocator_interface.h>.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*made)(const volatile void*, std::size_t),
                                                         void (*freed)(const volatile void*));

namespace {

thread_local std::size_t n_allocations = 0;  // malloc and every form of new, in this thread

void count(const volatile void*, std::size_t) { ++n_allocations; }
void ignore(const volatile void*) {}

}  // namespace

namespace chimera {
namespace {

struct Given {
  const char* component;
  void (*give)(Rig&);
};

void give_gains(Rig& rig) {
  rig.set("ndof", 2);
  for (std::size_t i = 0; i < 2; ++i)
    for (const char* port : {"q_ref", "qd_ref", "q", "qd", "kp", "ki", "kd", "tau_max"}) rig.set(port, 0.5, i);
  rig.set("filter_time", 0.002);
}
void give_motion(Rig& rig) {
  rig.set("ndof", 2);
  for (std::size_t i = 0; i < 2; ++i) {
    rig.set("start_pose", 0.0, i);
    rig.set("goal", 1.0, i);
  }
  rig.set("duration", 0.5);
  rig.set("profile", Text<16>("jerk"));
  rig.set("is_synchronised", true);
  for (const char* limit : {"velocity_max", "acceleration_max", "jerk_max"})
    for (std::size_t i = 0; i < 2; ++i) rig.set(limit, 1.0, i);
}
void give_inputs(Rig& rig) {
  rig.instances("in", 2);
  for (std::size_t i = 0; i < 2; ++i) rig.set("in", 0.5, 0, i);
}

const Given kComponents[] = {
    {"gain", [](Rig& rig) { rig.set("k", 2.0), rig.set("x", 1.0); }},
    {"tderiv", [](Rig& rig) { rig.set("x", 1.0); }},
    {"pid_joint", give_gains},
    {"joint_trajectory", give_motion},
    {"join_mean", [](Rig& rig) { give_inputs(rig), rig.instances("weight", 0); }},
    {"limit", [](Rig& rig) { rig.set("low", -1.0), rig.set("high", 1.0); }},
    {"deadband", [](Rig& rig) { rig.set("width", 0.1), rig.set("center", 0.0); }},
    {"rate_limit", [](Rig& rig) { rig.set("rise", 1.0), rig.set("fall", 1.0); }},
    {"lowpass", [](Rig& rig) { rig.set("cutoff", 50.0), rig.set("order", 8); }},
    {"notch", [](Rig& rig) { rig.set("center", 50.0), rig.set("width", 5.0); }},
    {"unit_convert", [](Rig& rig) { rig.set("factor", 2.0), rig.set("offset", 0.0); }},
    {"join_priority", [](Rig& rig) { give_inputs(rig), rig.set("max_age", 0.1); }},
    {"select", [](Rig& rig) { give_inputs(rig), rig.set("which", 1); }},
    {"signal_generator",
     [](Rig& rig) {
       rig.set("wave", Text<16>("noise"));
       for (const char* port : {"amplitude", "offset", "frequency", "phase", "end_frequency"}) rig.set(port, 0.5);
       rig.set("duration", 1.0), rig.set("delay", 0.0), rig.set("seed", std::int64_t{1});
     }},
    {"csv_player",
     [](Rig& rig) {
       rig.instances("out", 1), rig.joined("out", "signal", "1", 0);
       rig.resource("file", "csv_player/csv_player_example.csv");
       rig.set("is_repeated", true), rig.set("is_interpolated", true);
     }},
    {"watchdog",
     [](Rig& rig) {
       give_inputs(rig), rig.set("max_age", 0.1);
       rig.set("action", Text<16>("report")), rig.set("target", Text<64>(""));
     }},
    {"pid",
     [](Rig& rig) {
       for (const char* port : {"reference", "measured", "kp", "ki", "kd"}) rig.set(port, 0.5);
       rig.set("low", -1.0), rig.set("high", 1.0);
     }},
    {"sum", [](Rig& rig) { give_inputs(rig), rig.instances("weight", 0); }},
    {"offset", [](Rig& rig) { rig.set("offset", 0.5); }},
    {"lookup_table",
     [](Rig& rig) {
       rig.extent("points", 2);
       rig.set("at", 0.0, 0), rig.set("at", 1.0, 1), rig.set("value", 1.0, 0), rig.set("value", 1.0, 1);
     }},
    {"comparator", [](Rig& rig) { rig.set("level", 0.5); }},
    {"logic",
     [](Rig& rig) {
       rig.instances("in", 1), rig.instances("inverted", 0);
       rig.set("in", true), rig.set("function", Text<16>("not"));
     }},
    {"edge", [](Rig& rig) { rig.set("x", true); }},
    {"counter", [](Rig& rig) { rig.set("up", true), rig.set("down", true), rig.set("reset", false); }},
    {"encoder", [](Rig& rig) { rig.instances("in", 1), rig.set("in", 5.0), rig.set("span", 1.0); }},
    {"display", [](Rig& rig) { give_inputs(rig), rig.set("digits", 6), rig.set("title", Text<32>("")); }},
    {"csv_log", [](Rig& rig) { give_inputs(rig), rig.set("capacity", 10), rig.resource("file", "/dev/null"); }},
};

TEST(SignalComponents, AskTheHeapForNothingInTheirCycles) {
  ASSERT_NE(__sanitizer_install_malloc_and_free_hooks(count, ignore), 0);
  for (const Given& given : kComponents) {
    SignalRig rig(given.component);
    given.give(rig);
    const std::string_view with_x =
        "limit deadband rate_limit lowpass notch unit_convert offset comparator lookup_table";
    const bool has_x = with_x.find(given.component) != std::string_view::npos;
    if (has_x) rig.set("x", 0.5);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << given.component << ": " << made.text;
    const std::size_t before = n_allocations;
    bool went_well = static_cast<bool>(rig.on());
    for (int i = 0; i < 300; ++i) went_well = static_cast<bool>(rig.cycle()) && went_well;
    if (has_x) {
      rig.set("x", std::nan(""));
      went_well = rig.cycle().status == CHIMERA_FAULT && went_well;  // the rig allocates its text, below
      went_well = static_cast<bool>(rig.error()) && went_well;
    }
    went_well = static_cast<bool>(rig.off()) && went_well;
    const std::size_t texts = has_x ? 1 : 0;
    EXPECT_EQ(n_allocations - before, texts) << given.component;
    EXPECT_TRUE(went_well) << given.component;
  }
  const std::size_t before = n_allocations;
  delete new int(1);  // the hook counts this
  EXPECT_EQ(n_allocations, before + 1);
}

}  // namespace
}  // namespace chimera
