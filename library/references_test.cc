// SPDX-License-Identifier: Apache-2.0
// Every producer of references, in every way of coming back, starts where the machine is and moves on within its
// limits.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <set>
#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/task/rig.h"
#include "library/kinematics/puma560.h"

namespace chimera::references_test {
namespace {

constexpr double kBefore = 0.2, kElsewhere = 0.9, kHanded = 0.91;  // rad or m
constexpr double kNoEnd = 1e9;

std::string file_of_rows() {
  const std::string path = testing::TempDir() + "references_" + std::to_string(::getpid()) + ".csv";
  std::ofstream(path) << "t(s),q\n0,0.5\n100,0.6\n";
  return path;
}

struct Reference {
  const char *component, *output, *measured;
  double fastest;  // per second
  bool is_pose;
  std::size_t elements;
  std::function<void(Rig&)> give;
};

Pose pose_at(double x) { return {{x, 0.1, 0.3}, {1, 0, 0, 0}}; }

void give_limits(Rig& rig) {
  rig.set("ndof", std::int32_t{1});
  rig.set("start_pose", 0.0), rig.set("goal", 0.0), rig.set("profile", Text<16>("jerk"));
  rig.set("velocity_max", 0.5), rig.set("acceleration_max", 2.0), rig.set("jerk_max", 20.0);
}

void give_one_joint(Rig& rig) {
  rig.set("ndof", std::int32_t{1});
  rig.set("dh", library::DhLink{1, 0, 0, 0});
  rig.set("xr", Pose{{1, 0, 0}, {1, 0, 0, 0}});
  rig.set("speed_limit", 0.5);
}

void give_puma(Rig& rig) {
  const library::Puma560::Vector q{kElsewhere, kElsewhere, kElsewhere, kElsewhere, kElsewhere, kElsewhere};
  rig.set("xr", library::pose_of(library::Puma560::forward(q)));
}

void give_figure(Rig& rig) {
  rig.set("centre", pose_at(0.5));
  rig.set("amplitude", 0.1), rig.set("frequency", 0.2);
}

void give_wave(Rig& rig) {
  rig.extent("n", 1);
  rig.set("amplitude", 0.1), rig.set("offset", 0.5), rig.set("frequency", 0.2);
}

void give_rows(Rig& rig) {
  rig.extent("n", 1), rig.extent("m", 1);
  rig.instances("out", 1);
  rig.joined("out", "q", "1"), rig.joined("start", "measured", "1");
  rig.set("is_interpolated", true);
  rig.resource("file", file_of_rows().c_str());
}

void give_ramp(Rig& rig) {
  rig.extent("n", 1);
  rig.set("x", 0.0), rig.set("rise", 0.5), rig.set("fall", 0.5);
}

const Reference kReferences[] = {
    {"joint_trajectory", "q_ref", "q", 0.5, false, 1, give_limits},
    {"ctraj", "xd", "xm", 1, true, 1, give_figure},
    {"cinterp", "xr", "xm", 0.5, true, 1, [](Rig& r) { r.set("xd", pose_at(0.5)), r.set("leash", 10.0); }},
    {"ginvkin", "q_ref", "q", 0.5, false, 1, give_one_joint},
    {"pinvkin", "q_ref", "q", kNoEnd, false, 6, give_puma},
    {"tball", "xd", "xm", 0.1, true, 1,
     [](Rig& r) { r.resource("device", source_path("library/tball/wave.events").c_str()); }},
    {"visual_servo_interface", "xd", "xm", 0, true, 1,
     [](Rig& r) { r.set("camera", pose_at(0)), r.resource("link", "here:references"); }},
    {"time_integrator", "integral", "start", 0.1, false, 1,
     [](Rig& r) { r.extent("n", 1), r.set("rate_of_change", 0.1); }},
    {"rate_limit", "y", "start", 0.5, false, 1, give_ramp},
    {"signal_generator", "y", "start", 1, false, 1, give_wave},
    {"csv_player", "out", "start", 1, false, 1, give_rows}};

/// Moves speeds, not places, which start at 0 (damped_least_squares), or carries a person's wish (ccui).
const std::set<std::string> kOthers{"damped_least_squares", "ccui"};

struct Machine : ::testing::TestWithParam<Reference> {
  std::unique_ptr<Rig> rig;

  static void TearDownTestSuite() { ::unlink(file_of_rows().c_str()); }
  void put(const char* port, double value) const {
    for (std::size_t i = 0; i < GetParam().elements; ++i)
      GetParam().is_pose ? rig->set(port, pose_at(value)) : rig->set(port, value, i);
  }
  double reference() const {
    const char* output = GetParam().output;
    return GetParam().is_pose ? rig->get<Pose>(output).position[0] : rig->get<double>(output);
  }
  void make(double place) {
    rig = std::make_unique<Rig>(GetParam().component);
    GetParam().give(*rig);
    put(GetParam().measured, place);
    const RigAnswer made = rig->init();
    ASSERT_TRUE(made) << made.text;
  }
  /// Runs at one place; then the machine is moved to another.
  void run_then_move() {
    make(kBefore);
    ASSERT_TRUE(rig->on());
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig->cycle());
    put(GetParam().measured, kElsewhere);
  }
  void come_back(double reference_before, Nanoseconds age) {
    if (std::isfinite(reference_before)) put(GetParam().output, reference_before);
    rig->inherit(GetParam().output, age);
    const RigAnswer back = rig->on();
    ASSERT_TRUE(back) << back.text;
  }
  /// The reference is at `place` and stays within its limits.
  void expect_from(double place, double tolerance = 1e-12) {
    double last = reference();
    EXPECT_NEAR(last, place, tolerance);
    for (int i = 0; i < 3000; ++i) {
      const RigAnswer answer = rig->cycle();
      ASSERT_TRUE(answer) << answer.text;
      ASSERT_LE(std::abs(reference() - last), GetParam().fastest * 1e-3 + 1e-9) << "cycle " << i;
      last = reference();
    }
  }
};

constexpr double kAsItWas = NAN;

TEST_P(Machine, FirstStart) {
  make(kElsewhere);
  ASSERT_TRUE(rig->on());
  expect_from(kElsewhere);
}

TEST_P(Machine, OffAndOn) {
  run_then_move();
  ASSERT_TRUE(rig->off());
  come_back(kAsItWas, seconds(1));
  expect_from(kElsewhere);
}

TEST_P(Machine, SwitchedInLongAfterAnotherProducer) {
  run_then_move();
  ASSERT_TRUE(rig->off());
  come_back(5, seconds(1));
  expect_from(kElsewhere);
}

TEST_P(Machine, SwitchedInForAProducerThatWasOn) {
  run_then_move();
  ASSERT_TRUE(rig->off());
  come_back(kHanded, milliseconds(2));
  expect_from(kHanded);
}

TEST_P(Machine, Reinitialised) {
  run_then_move();
  ASSERT_TRUE(rig->off());
  ASSERT_TRUE(rig->reinit());
  come_back(kAsItWas, seconds(1));
  expect_from(kElsewhere);
}

TEST_P(Machine, ClearedAfterAFault) {
  run_then_move();
  (void)rig->error();
  ASSERT_TRUE(rig->clear());
  come_back(kAsItWas, seconds(1));
  expect_from(kElsewhere);
}

TEST_P(Machine, FlagUpAndDown) {
  run_then_move();
  rig->illegal(true);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig->cycle());
  const double held = reference();
  ASSERT_TRUE(rig->cycle());
  EXPECT_EQ(reference(), held);
  rig->illegal(false);
  ASSERT_TRUE(rig->cycle());
  expect_from(kElsewhere, GetParam().fastest * 1e-3 + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(References, Machine, ::testing::ValuesIn(kReferences),
                         [](const auto& of) { return std::string(of.param.component); });

TEST(References, EveryProducerOfAReferenceIsTried) {
  std::set<std::string> tried = kOthers;
  for (const Reference& reference : kReferences) tried.insert(reference.component);
  std::uint32_t count = 0;
  const chimera_component* const* all = chimera_components(CHIMERA_ABI_VERSION, &count);
  ASSERT_GT(count, 50u);
  for (std::uint32_t c = 0; c < count; ++c)
    for (std::uint32_t p = 0; p < all[c]->n_ports; ++p) {
      const std::string port = all[c]->ports[p].name;
      const bool is_reference = port == "q_ref" || port == "qd_ref" || port == "xd" || port == "xr" || port == "vr";
      if (is_reference && all[c]->ports[p].kind == CHIMERA_OUT_VAR) {
        EXPECT_TRUE(tried.contains(all[c]->name)) << all[c]->name;
      }
    }
}

}  // namespace
}  // namespace chimera::references_test
