// SPDX-License-Identifier: Apache-2.0
// Each picture response.svg or frequency.svg shows the present response of its component. UPDATE=1 draws all again:
// view them before a commit.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "chimera/base/testing/tree_path.h"
#include "chimera/draw/plot.h"
#include "chimera/task/geometry.h"
#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

using draw::Curve;
using draw::Plot;

void compare(const std::string& component, const Plot& plot, const std::string& name = "response") {
  const std::string path = source_path("library/" + component + "/" + name + ".svg");
  const std::string drawn = draw::svg(plot);
  if (std::getenv("UPDATE") != nullptr) std::ofstream(path) << drawn;
  std::ostringstream committed;
  committed << std::ifstream(path).rdbuf();
  EXPECT_TRUE(committed.str() == drawn) << path << " is out of date: UPDATE=1 draws it anew";
}

Plot titled(const std::string& title, const std::string& note) {
  Plot plot;
  plot.title = title;
  plot.note = note;
  return plot;
}

/// Input `signal(t)` and output of the filter, every `ms` milliseconds until `until` seconds.
template <class Signal>
std::vector<Curve> in_and_out(SignalRig& rig, double until, std::int64_t ms, Signal signal) {
  rig.set("x", 0.0);
  EXPECT_TRUE(rig.init());
  EXPECT_TRUE(rig.on());
  Curve in{"x", "1", {}}, out{"y", "1", {}};
  for (double t = 0; t < until; t += static_cast<double>(ms) * 1e-3) {
    in.points.push_back({t, signal(t)});
    out.points.push_back({t, rig.step(signal(t), milliseconds(ms))});
  }
  return {in, out};
}

double sine(double hz, double t) { return std::sin(2 * std::numbers::pi * hz * t); }

/// The answer of a filter to 1 from 10 ms on.
Curve step_of(SignalRig& rig, const std::string& name, double until) {
  Curve curve{name, "1", {}};
  rig.set("x", 0.0);
  EXPECT_TRUE(rig.init());
  EXPECT_TRUE(rig.on());
  for (double t = 0; t < until; t += 1e-3) curve.points.push_back({t, rig.step(t < 0.0095 ? 0 : 1)});
  return curve;
}

/// Gain in dB and phase in degrees at 1 kHz, from what the filter answers to a single 1: exact, because it is linear.
struct Bode {
  Curve gain, phase;

  Bode(SignalRig& rig, const std::string& name, double from, double to)
      : gain{name, "dB", {}}, phase{name + " ", "degrees", {}} {
    constexpr int kAnswer = 6000, kFrequencies = 400;
    rig.set("x", 0.0);
    EXPECT_TRUE(rig.init());
    EXPECT_TRUE(rig.on());
    std::vector<double> answer;
    for (int i = 0; i < kAnswer; ++i) answer.push_back(rig.step(i == 0 ? 1 : 0));
    double before = 0;
    for (int f = 0; f <= kFrequencies; ++f) {
      const double hz = from * std::pow(to / from, f / static_cast<double>(kFrequencies));
      const std::complex<double> step = std::polar(1.0, -2 * std::numbers::pi * hz * 1e-3);
      std::complex<double> sum = 0;
      for (std::size_t i = answer.size(); i-- > 0;) sum = sum * step + answer[i];
      const double decibels = 20 * std::log10(std::abs(sum));
      double degrees = std::arg(sum) * 180 / std::numbers::pi;
      while (degrees - before > 180) degrees -= 360;
      while (degrees - before < -180) degrees += 360;
      before = degrees;
      const bool is_seen = decibels > -100;
      gain.points.push_back({hz, is_seen ? decibels : std::nan("")});
      phase.points.push_back({hz, is_seen ? degrees : std::nan("")});
    }
  }
};

TEST(Responses, LowpassOverFrequency) {
  Plot plot{.title = "lowpass: gain and phase", .note = "cutoff 20 Hz at 1 kHz; the dashed line is the cutoff, -3 dB",
            .curves = {}, .gaps = {}, .mark = 20, .level = -3.0103, .level_unit = "dB", .is_over_frequency = true};
  for (const std::int32_t order : {1, 2, 4, 8}) {
    SignalRig rig("lowpass");
    rig.set("cutoff", 20.0), rig.set("order", order);
    const Bode bode(rig, "order " + std::to_string(order), 1, 400);
    plot.curves.push_back(bode.gain), plot.curves.push_back(bode.phase);
  }
  compare("lowpass", plot, "frequency");
}

TEST(Responses, NotchOverFrequency) {
  Plot plot{.title = "notch: gain and phase", .note = "center 50 Hz at 1 kHz, three widths", .curves = {}, .gaps = {},
            .mark = 50, .level = -3.0103, .level_unit = "dB", .is_over_frequency = true};
  for (const double width : {2.0, 10.0, 50.0}) {
    SignalRig rig("notch");
    rig.set("center", 50.0), rig.set("width", width);
    const Bode bode(rig, "width " + std::to_string(static_cast<int>(width)) + " Hz", 5, 480);
    plot.curves.push_back(bode.gain), plot.curves.push_back(bode.phase);
  }
  compare("notch", plot, "frequency");
}

TEST(Responses, LowpassToAStep) {
  Plot plot = titled("lowpass: a step at 10 ms", "cutoff 20 Hz at 1 kHz");
  for (const std::int32_t order : {1, 2, 4, 8}) {
    SignalRig rig("lowpass");
    rig.set("cutoff", 20.0);
    rig.set("order", order);
    plot.curves.push_back(step_of(rig, "order " + std::to_string(order), 0.15));
  }
  compare("lowpass", plot);
}

TEST(Responses, NotchToAToneAndAStep) {
  Plot plot = titled("notch: a step of 1 with a tone of 50 Hz", "center 50 Hz, width 10 Hz at 1 kHz");
  SignalRig rig("notch");
  rig.set("center", 50.0);
  rig.set("width", 10.0);
  plot.curves = in_and_out(rig, 0.3, 1, [](double t) { return (t < 0.15 ? 0 : 1) + 0.5 * sine(50, t); });
  compare("notch", plot);
}

TEST(Responses, DeadbandRateLimitAndLimitToASine) {
  struct Shaper {
    const char* component;
    const char* note;
    std::vector<std::pair<const char*, double>> constants;
  };
  for (const Shaper& shaper : {Shaper{"deadband", "width 0.3", {{"width", 0.3}, {"center", 0.0}}},
                               Shaper{"rate_limit", "rise 2 /s, fall 6 /s", {{"rise", 2.0}, {"fall", 6.0}}},
                               Shaper{"limit", "low -0.4, high 0.8", {{"low", -0.4}, {"high", 0.8}}}}) {
    Plot plot = titled(std::string(shaper.component) + ": a sine of 1 Hz", shaper.note);
    SignalRig rig(shaper.component);
    for (const auto& [name, value] : shaper.constants) rig.set(name, value);
    plot.curves = in_and_out(rig, 2, 5, [](double t) { return sine(1, t); });
    compare(shaper.component, plot);
  }
}

TEST(Responses, SignalGeneratorInItsSevenWaves) {
  Plot plot = titled("signal_generator: its seven waves",
                     "1 Hz, amplitude 1; the chirp from 1 Hz to 5 Hz in 3 s; delay 0.25 s");
  constexpr const char* kWaves[] = {"sine", "triangle", "square", "sawtooth", "chirp", "step", "noise"};
  for (int i = 0; i < 7; ++i) {
    SignalRig rig("signal_generator");
    rig.set("wave", Text<16>(kWaves[i]));
    rig.set("amplitude", 1.0), rig.set("delay", 0.25), rig.set("end_frequency", 5.0), rig.set("duration", 3.0);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
    // Two curves in each panel: seven in one could not be distinguished.
    Curve curve{kWaves[i], "1", {}, i / 2};
    for (double t = 0; t < 3; t += 5e-3) {
      curve.points.push_back({t, rig.get<double>("y")});
      ASSERT_TRUE(rig.cycle(milliseconds(5)));
    }
    plot.curves.push_back(curve);
  }
  compare("signal_generator", plot);
}

TEST(Responses, CinterpToAStepOfItsGoal) {
  Rig rig("cinterp");
  const Pose here{{0.5, 0, 0.3}, {1, 0, 0, 0}}, there{{0.5, 0.2, 0.4}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}};
  rig.set("xm", here), rig.set("xd", here), rig.set("leash", 10.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  Curve y{"y", "m", {}}, z{"z", "m", {}}, wanted_y{"y wanted", "m", {}}, wanted_z{"z wanted", "m", {}};
  Curve turn{"turn", "rad", {}}, wanted{"turn wanted", "rad", {}};
  for (int i = 0; i < 2500; ++i) {
    const double t = i * 1e-3;
    const Pose goal = i < 100 ? here : there;
    rig.set("xd", goal);
    ASSERT_TRUE(rig.cycle());
    const Pose xr = rig.get<Pose>("xr");
    y.points.push_back({t, xr.position[1]}), wanted_y.points.push_back({t, goal.position[1]});
    z.points.push_back({t, xr.position[2]}), wanted_z.points.push_back({t, goal.position[2]});
    turn.points.push_back({t, 2 * std::atan2(xr.orientation[3], xr.orientation[0])});
    wanted.points.push_back({t, 2 * std::atan2(goal.orientation[3], goal.orientation[0])});
  }
  compare("cinterp", {.title = "cinterp: another goal at 0.1 s", .note = "gain 10 /s, at most 0.5 m/s and 1 rad/s",
                      .curves = {y, wanted_y, z, wanted_z, turn, wanted}, .gaps = {}, .mark = {}, .level_unit = {}});
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
