// SPDX-License-Identifier: Apache-2.0
// Row 19: one cycle of each component of the cruise control, and of those that schedules and tests are made of, beside
// the same law written out.
// Components: accel brake busy car ccui control control_pm dashboard electric_car engine faulty motor position
// Components: split_pm split_pm_override wheels on_event ringer sequence
#include <algorithm>
#include <cmath>

#include "bench/component.h"
#include "library/car/car_model.h"
#include "library/control/pi.h"
#include "library/script/script.h"
#include "library/sequence/step.h"

namespace chimera {
namespace {

using bench::ComponentCase;
using library::ArmRig;

/// `law(x)`, n times; neither x nor what comes of it is known to the compiler.
template <class Law>
bench::Comparison::Body repeated(Law law, double x) {
  return [law, x](std::uint64_t n) mutable {
    for (double y = 0; n > 0; --n) bench::keep(x), y = law(x), bench::keep(y);
  };
}

/// A pedal half way between two points of its script: `line` or `step` from the same points in an array.
bench::Comparison::Body pedal(bool is_line) {
  return [is_line](std::uint64_t n) {
    static double at[3] = {0, 1e9, 2e9}, value[3] = {0.2, 1, 0};
    double y = 0;
    for (double t = 0; n > 0; --n, t += 1e-3) {
      bench::keep(at), bench::keep(value);
      int i = 0;
      while (i < 2 && at[i + 1] <= t) ++i;
      y = 2280 * (is_line ? value[i] + (value[i + 1] - value[i]) * (t - at[i]) / (at[i + 1] - at[i]) : value[i]);
      bench::keep(y);
    }
  };
}

std::vector<ComponentCase> drivers() {
  const auto press = [](ArmRig& rig) { rig.resource("pedal", "0:0.2 1e9:1 2e9:0"); };
  return {{"accel", "line between points", press, pedal(true)},
          {"brake", "line between points", press, pedal(true)},
          {"ccui", "step of points", [](ArmRig& rig) { rig.resource("buttons", "0:80 1e9:100 2e9:0"); }, pedal(false)},
          {"position", "floor of counts", [](ArmRig& rig) { rig.set("xw", 12.3); },
           repeated([](double x) { return std::floor(x / 1e-4) * 1e-4 * 0.3; }, 12.3)},
          {"dashboard", "round and floor", [](ArmRig& rig) { rig.set("vz", 27.8), rig.set("xz", 1234.0); },
           repeated([](double x) { return std::round(x * 3.6) + std::floor(x / 100) / 10; }, 27.8)}};
}

std::vector<ComponentCase> controls() {
  const auto forces = [](ArmRig& rig) { rig.set("fd", 500.0); };
  return {{"control", "PI with limits", [](ArmRig& rig) { rig.set("vr", 27.0), rig.set("vz", 26.9); },
           repeated([pi = library::Pi()](double x) mutable { return pi.step(2500, 600, x, 1e-3, -4000, 2280); }, 0.1)},
          {"control_pm", "PI with limits, two maxima",
           [](ArmRig& rig) { rig.set("vr", 27.0), rig.set("vz", 26.9); },
           repeated(
               [pi = library::Pi()](double x) mutable {
                 const double force = pi.step(2500, 600, x, 1e-3, -4000, 2280);
                 return std::max(0.0, force) - std::max(0.0, -force);
               },
               0.1)},
          {"split_pm", "two maxima", forces,
           repeated([](double x) { return std::max(0.0, x) - std::max(0.0, -x); }, 500)},
          {"split_pm_override", "two maxima",
           [forces](ArmRig& rig) { forces(rig), rig.set("fra", 0.0), rig.set("frb", 0.0); },
           repeated([](double x) { return std::max(0.0, x) - std::max(0.0, -x); }, 500)},
          {"engine", "clamp", [](ArmRig& rig) { rig.set("fde", 500.0); },
           repeated([](double x) { return std::clamp(x / 2280, 0.0, 1.0); }, 500)},
          {"wheels", "clamp", [](ArmRig& rig) { rig.set("fdw", 500.0); },
           repeated([](double x) { return std::clamp(x, 0.0, 12000.0); }, 500)},
          {"motor", "clamp", forces, repeated([](double x) { return std::clamp(x, -5000.0, 5000.0); }, 500)}};
}

/// A sequence that waits for a value.
void two_steps(ArmRig& rig) {
  for (const char* port : {"value", "level"}) rig.instances(port, 1);
  rig.instances("configuration", 2);
  rig.extent("n", 1);
  rig.extent("steps", 2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    rig.set("configuration", Text<72>("near"), 0, i);
    rig.set("step", library::Step{"near", 3600, 3600.0 * i, i == 0 ? 0 : -1, 0, 1, -1, false, false}, i);
  }
  rig.set("level", 5.0);
  rig.set("value", 6.0);
  rig.set("sequence_go", 1);
  rig.configuration("near");
}

std::vector<ComponentCase> worlds() {
  library::CarModel car;
  const auto drive = [car](double force) mutable {
    car.step(force, 0, 0, 1e-3);
    return car.speed();
  };
  return {{"car", "law of motion", [](ArmRig& rig) {
             rig.set("gas", 0.2), rig.set("fb", 0.0), rig.resource("road", "0:0"); }, repeated(drive, 400)},
          {"electric_car", "law of motion",
           [](ArmRig& rig) { rig.set("fm", 400.0), rig.resource("road", "0:0"); }, repeated(drive, 400)},
          {"busy", "sum of times", [](ArmRig& rig) { rig.set("time", 1e-3); },
           repeated([sum = std::int64_t{0}](double x) mutable {
             sum += std::llround(x * 1e9);
             return static_cast<double>(sum);
           }, 1e-3)},
          {"on_event", "sum and count", [](ArmRig& rig) { rig.set("time", 1e-3); },
           repeated([sum = std::int64_t{0}, count = std::int64_t{0}](double x) mutable {
             sum += std::llround(x * 1e9);
             return static_cast<double>(sum + ++count);
           }, 1e-3)},
          {"ringer", "countdown", [](ArmRig& rig) {
             rig.set("target", Text<64>("x")), rig.set("every", std::int64_t{1'000'000'000}); },
           repeated([left = std::int64_t{1'000'000'000}](double x) mutable { return --left > 0 ? x : 0; }, 1)},
          {"sequence", "comparison", two_steps, repeated([](double x) { return x <= 5 ? 2.0 : 1.0; }, 6)},
          {"faulty", "counter", [](ArmRig&) {}, repeated([](double x) { return x + 1; }, 0)}};
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  using namespace chimera;
  const bench::Stage stage;
  int worst = 0;
  for (const auto& cases : {drivers(), controls(), worlds()})
    worst = std::max(worst, bench::measure(19, cases, argc, argv));
  return worst;
}
