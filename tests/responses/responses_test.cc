// SPDX-License-Identifier: Apache-2.0
// Each picture response.svg of a signal component is what the component answers today. UPDATE=1 draws them anew: look
// at them before they are committed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "chimera/draw/plot.h"
#include "library/signals/signal_rig.h"

namespace chimera {
namespace {

using draw::Curve;
using draw::Plot;

void compare(const std::string& component, const Plot& plot) {
  const char* source = std::getenv("CHIMERA_SOURCE");
  const std::string path = std::string(source != nullptr ? source : ".") + "/library/" + component + "/response.svg";
  const std::string drawn = draw::svg(plot);
  if (std::getenv("UPDATE") != nullptr) std::ofstream(path) << drawn;
  std::ostringstream committed;
  committed << std::ifstream(path).rdbuf();
  EXPECT_TRUE(committed.str() == drawn) << path << " is out of date: UPDATE=1 draws it anew";
}

/// The answer of a filter to 1 from 10 ms on.
Curve step_of(SignalRig& rig, const std::string& name, double until) {
  Curve curve{name, "1", {}};
  rig.set("x", 0.0);
  EXPECT_TRUE(rig.init());
  EXPECT_TRUE(rig.on());
  for (double t = 0; t < until; t += 1e-3) curve.points.push_back({t, rig.step(t < 0.0095 ? 0 : 1)});
  return curve;
}

TEST(Responses, LowpassToAStep) {
  Plot plot{.title = "lowpass: a step at 10 ms", .note = "cutoff 20 Hz at 1 kHz", .curves = {}, .gaps = {}, .mark = {},
            .level_unit = {}};
  for (const std::int32_t order : {1, 2, 4, 8}) {
    SignalRig rig("lowpass");
    rig.set("cutoff", 20.0);
    rig.set("order", order);
    plot.curves.push_back(step_of(rig, "order " + std::to_string(order), 0.15));
  }
  compare("lowpass", plot);
}

TEST(Responses, NotchToAToneAndAStep) {
  Plot plot{.title = "notch: a step of 1 with a tone of 50 Hz", .note = "center 50 Hz, width 10 Hz at 1 kHz",
            .curves = {}, .gaps = {}, .mark = {}, .level_unit = {}};
  SignalRig rig("notch");
  rig.set("center", 50.0);
  rig.set("width", 10.0);
  rig.set("x", 0.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  Curve in{"x", "1", {}}, out{"y", "1", {}};
  for (double t = 0; t < 0.3; t += 1e-3) {
    const double x = (t < 0.15 ? 0 : 1) + 0.5 * std::sin(2 * std::numbers::pi * 50 * t);
    in.points.push_back({t, x});
    out.points.push_back({t, rig.step(x)});
  }
  plot.curves = {in, out};
  compare("notch", plot);
}

TEST(Responses, DeadbandAndRateLimitToASine) {
  for (const char* component : {"deadband", "rate_limit"}) {
    SignalRig rig(component);
    const bool is_deadband = std::string(component) == "deadband";
    if (is_deadband) rig.set("width", 0.3), rig.set("center", 0.0);
    else rig.set("rise", 2.0), rig.set("fall", 6.0);
    rig.set("x", 0.0);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
    Curve in{"x", "1", {}}, out{"y", "1", {}};
    for (double t = 0; t < 2; t += 5e-3) {
      const double x = std::sin(2 * std::numbers::pi * t);
      in.points.push_back({t, x});
      out.points.push_back({t, rig.step(x, milliseconds(5))});
    }
    compare(component, {.title = std::string(component) + ": a sine of 1 Hz",
                        .note = is_deadband ? "width 0.3" : "rise 2 /s, fall 6 /s", .curves = {in, out}, .gaps = {},
                        .mark = {}, .level_unit = {}});
  }
}

TEST(Responses, JointTrajectoryInItsThreeProfiles) {
  Plot plot{.title = "joint_trajectory: 1 rad in its three profiles",
            .note = "limits 1 rad/s, 2 rad/s2, 10 rad/s3; the quintic in 2 s", .curves = {}, .gaps = {}, .mark = {},
            .level_unit = {}};
  const char* const ports[] = {"q_ref", "qd_ref", "qdd_ref"};
  const char* const units[] = {"rad", "rad/s", "rad/s2"};
  for (int p = 0; p < 3; ++p)
    for (const char* profile : {"quintic", "trapezoid", "jerk"}) {
      Rig rig("joint_trajectory");
      rig.set("ndof", 1);
      rig.set("start_pose", 0.0);
      rig.set("goal", 1.0);
      rig.set("duration", profile[0] == 'q' ? 2.0 : 0.0);
      rig.set("profile", Text<16>(profile));
      rig.set("velocity_max", 1.0);
      rig.set("acceleration_max", 2.0);
      rig.set("jerk_max", 10.0);
      rig.set("is_synchronised", true);
      ASSERT_TRUE(rig.init());
      ASSERT_TRUE(rig.on());
      Curve curve{p == 0 ? profile : std::string(profile) + " ", units[p], {}};
      for (double t = 0; t < 2.2; t += 0.01) {
        curve.points.push_back({t, rig.get<double>(ports[p])});
        ASSERT_TRUE(rig.cycle(milliseconds(10)));
      }
      plot.curves.push_back(curve);
    }
  compare("joint_trajectory", plot);
}

}  // namespace
}  // namespace chimera
