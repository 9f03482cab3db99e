// SPDX-License-Identifier: Apache-2.0
// Row 19: one cycle of each signal component, six elements (three inputs of six where there are several), beside the
// same law as a plain loop over arrays. What a component costs above it: the call through the interface, the views of
// its ports, and the look for NaN.
// Components: gain tderiv join_mean pid_joint joint_trajectory limit deadband rate_limit lowpass notch unit_convert
// Components: join_priority select signal_generator csv_player watchdog
// Components: servo_axis pid sum offset lookup_table comparator logic edge counter encoder
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>

#include "bench/component.h"
#include "library/joint_trajectory/quintic.h"

namespace chimera {
namespace {

constexpr std::size_t kJoints = 6;
using Joints = std::array<double, kJoints>;

using bench::ComponentCase;
using BenchRig = library::ArmRig;

void fill(BenchRig& rig, const char* port, double value, std::size_t instance = 0) {
  for (std::size_t i = 0; i < kJoints; ++i) rig.set(port, value + 0.01 * static_cast<double>(i), i, instance);
}

/// `law(i)` for every element, n times.
template <class Law>
std::function<void(std::uint64_t)> loop(Law law) {
  return [law](std::uint64_t n) mutable {
    static Joints x{0.1, 0.2, 0.3, 0.4, 0.5, 0.6}, y{};
    while (n--) {
      bench::keep(x);
      for (std::size_t i = 0; i < kJoints; ++i) y[i] = law(i, x[i], y[i]);
      bench::keep(y);
    }
  };
}

/// Direct form II transposed, as textbooks print it: five coefficients.
struct Biquad {
  double b0 = 0.2, b1 = 0.4, b2 = 0.2, a1 = -0.4, a2 = 0.2;
  Joints s1{}, s2{};
  double operator()(std::size_t i, double x, double) {
    const double y = b0 * x + s1[i];
    s1[i] = b1 * x - a1 * y + s2[i];
    s2[i] = b2 * x - a2 * y;
    return y;
  }
};

/// An axis with inertia and viscous friction, by its solution for one cycle.
struct AxisLaw {
  Joints velocity{};
  double operator()(std::size_t i, double torque, double position) {
    const double before = velocity[i], acceleration = torque / 0.5;
    velocity[i] = before * 0.9998 + acceleration * 0.9999e-3;
    return position + before * 0.9999e-3 + acceleration * 0.49997e-6;
  }
};

struct PidLaw {
  Joints integral{}, filtered{};
  double operator()(std::size_t i, double x, double) {
    const double error = 1 - x, rate = 0.5 - x;
    filtered[i] += (rate - filtered[i]) * (1e-3 / 3e-3);
    integral[i] += 50 * error * 1e-3;
    return std::clamp(100 * error + 10 * filtered[i] + integral[i], -200.0, 200.0);
  }
};

void give_motion(BenchRig& rig, const char* profile) {
  rig.set("ndof", static_cast<std::int32_t>(kJoints));
  for (const char* port : {"start_pose", "goal"}) fill(rig, port, port[0] == 'g' ? 1e5 : 0);
  fill(rig, "velocity_max", 1), fill(rig, "acceleration_max", 2), fill(rig, "jerk_max", 20);
  rig.set("duration", 3600.0), rig.set("is_synchronised", true), rig.set("profile", Text<16>(profile));
}

void give_inputs(BenchRig& rig) {
  rig.instances("in", 3);
  for (std::size_t i = 0; i < 3; ++i) fill(rig, "in", 0.5, i);
}

std::vector<ComponentCase> signal_cases() {
  return {
      {"gain", "k x", [](BenchRig& r) { r.set("x", 1.0), r.set("k", 2.0); },
       [](std::uint64_t n) {
         double x = 1, y = 0;
         for (; n > 0; --n) bench::keep(x), y = 2 * x, bench::keep(y);
       }},
      {"limit", "clamp", [](BenchRig& r) { fill(r, "x", 0.1), fill(r, "low", -1), fill(r, "high", 1); },
       loop([](std::size_t, double x, double) { return std::clamp(x, -1.0, 1.0); })},
      {"deadband", "two branches", [](BenchRig& r) { fill(r, "x", 0.1), fill(r, "width", 0.2), fill(r, "center", 0); },
       loop([](std::size_t, double x, double) { return x > 0.2 ? x - 0.2 : x < -0.2 ? x + 0.2 : 0; })},
      {"rate_limit", "clamp about y", [](BenchRig& r) { fill(r, "x", 0.1), fill(r, "rise", 1), fill(r, "fall", 1); },
       loop([](std::size_t, double x, double y) { return std::clamp(x, y - 1e-3, y + 1e-3); })},
      {"unit_convert", "k x + c", [](BenchRig& r) { fill(r, "x", 0.1), r.set("factor", 57.3), r.set("offset", 0.0); },
       loop([](std::size_t, double x, double) { return 57.3 * x; })},
      {"lowpass", "biquad, direct form II",
       [](BenchRig& r) { fill(r, "x", 0.1), r.set("cutoff", 50.0), r.set("order", 2); },
       loop(Biquad{})},
      {"notch", "biquad, direct form II",
       [](BenchRig& r) { fill(r, "x", 0.1), r.set("center", 50.0), r.set("width", 5.0); },
       loop(Biquad{})},
  };
}

std::vector<ComponentCase> other_cases() {
  return {
      {"tderiv", "(x - last) / dt", [](BenchRig& r) { r.set("x", 1.0); },
       [](std::uint64_t n) {
         double x = 1, last = 0, y = 0;
         for (; n > 0; --n) bench::keep(x), y = (x - last) / 1e-3, last = x, bench::keep(y);
       }},
      {"join_mean", "mean of 3", [](BenchRig& r) { r.instances("in", 3), r.instances("weight", 0);
         for (std::size_t i = 0; i < 3; ++i) r.set("in", 0.5, 0, i); },
       [](std::uint64_t n) {
         double x[3] = {1, 2, 3}, y = 0;
         for (; n > 0; --n) bench::keep(x), y = (x[0] + x[1] + x[2]) / 3, bench::keep(y);
       }},
      {"join_priority", "copy of 6", [](BenchRig& r) { give_inputs(r), r.set("max_age", 0.0); },
       loop([](std::size_t, double x, double) { return x; })},
      {"select", "copy of 6", [](BenchRig& r) { give_inputs(r), r.set("which", 1); },
       loop([](std::size_t, double x, double) { return x; })},
      {"watchdog", "3 comparisons", [](BenchRig& r) { give_inputs(r), r.set("max_age", 86400.0);
         r.set("action", Text<16>("report")), r.set("target", Text<64>("")); },
       [](std::uint64_t n) {
         std::int64_t x[3] = {1, 2, 3}, now = 5;
         bool y = false;
         for (; n > 0; --n) bench::keep(x), y = now - x[0] < 9 && now - x[1] < 9 && now - x[2] < 9, bench::keep(y);
       }},
      {"signal_generator", "6 std::sin", [](BenchRig& r) {
         fill(r, "amplitude", 1), fill(r, "offset", 0), fill(r, "phase", 0);
         r.set("wave", Text<16>("sine")), r.set("frequency", 1.0), r.set("end_frequency", 1.0);
         r.set("duration", 1.0), r.set("delay", 0.0), r.set("seed", std::int64_t{1}); },
       [](std::uint64_t n) {
         static Joints y{};
         for (double t = 0; n > 0; --n, t += 1e-3) {
           for (std::size_t i = 0; i < kJoints; ++i) y[i] = std::sin(6.28 * t + 0.01 * static_cast<double>(i));
           bench::keep(y);
         }
       }},
  };
}

/// `law(is, was)` for every element, n times: truth values that stand.
template <class Law>
std::function<void(std::uint64_t)> truths(Law law) {
  return [law](std::uint64_t n) mutable {
    static std::array<bool, kJoints> x{}, last{}, y{};
    while (n--) {
      bench::keep(x);
      for (std::size_t i = 0; i < kJoints; ++i) y[i] = law(i, x[i], last[i]), last[i] = x[i];
      bench::keep(y);
    }
  };
}

void give_truths(BenchRig& rig, std::initializer_list<const char*> ports) {
  for (const char* port : ports)
    for (std::size_t i = 0; i < kJoints; ++i) rig.set(port, false, i);
}

/// 16 points, and the piece found by halving.
struct CurveLaw {
  std::array<double, 16> at{}, value{};
  CurveLaw() {
    for (std::size_t k = 0; k < 16; ++k) at[k] = 0.1 * static_cast<double>(k), value[k] = at[k] * at[k];
  }
  double operator()(std::size_t, double x, double) const {
    const auto k = static_cast<std::size_t>(std::upper_bound(at.begin() + 1, at.end() - 1, x) - at.begin());
    return value[k - 1] + (x - at[k - 1]) * (value[k] - value[k - 1]) / (at[k] - at[k - 1]);
  }
};

void give_curve(BenchRig& rig) {
  fill(rig, "x", 0.5), rig.extent("points", 16);
  for (std::size_t k = 0; k < 16; ++k)
    rig.set("at", 0.1 * static_cast<double>(k), k), rig.set("value", static_cast<double>(k), k);
}

std::vector<ComponentCase> block_cases() {
  return {
      {"sum", "x + x + x", [](BenchRig& r) { give_inputs(r), r.instances("weight", 0); },
       loop([](std::size_t, double x, double) { return x + x + x; })},
      {"offset", "x + c", [](BenchRig& r) { fill(r, "x", 0.1), fill(r, "offset", 0.5); },
       loop([](std::size_t, double x, double) { return x + 0.5; })},
      {"lookup_table", "upper_bound, line", give_curve, loop(CurveLaw{})},
      {"comparator", "two comparisons",
       [](BenchRig& r) { fill(r, "x", 0.1), fill(r, "level", 0.3), fill(r, "hysteresis", 0.1); },
       loop([](std::size_t, double x, double y) { return x > 0.35   ? 1
                                                         : x < 0.25 ? 0
                                                                    : y; })},
      {"logic", "and of 18",
       [](BenchRig& r) {
         r.instances("in", 3), r.instances("inverted", 0);
         for (std::size_t k = 0; k < 3; ++k)
           for (std::size_t i = 0; i < kJoints; ++i) r.set("in", true, i, k);
         r.set("function", Text<16>("and"));
       },
       [](std::uint64_t n) {
         static std::array<bool, 3 * kJoints> x{};
         bool y = false;
         for (; n > 0; --n) bench::keep(x), y = std::ranges::all_of(x, std::identity{}), bench::keep(y);
       }},
      {"edge", "x and not last", [](BenchRig& r) { give_truths(r, {"x"}), r.set("duration", 0.0); },
       truths([](std::size_t, bool is, bool was) { return is && !was; })},
      {"counter", "count += x and not last",
       [](BenchRig& r) {
         give_truths(r, {"up", "down", "reset"});
       },
       truths([count = std::array<std::int64_t, kJoints>{}](std::size_t i, bool is, bool was) mutable {
         return (count[i] += is && !was ? 1 : 0) > 100;
       })},
      {"encoder", "difference of counts",
       [](BenchRig& r) {
         r.instances("in", 1);
         fill(r, "in", 7), fill(r, "span", 1), r.set("counts", std::int64_t{4096});
       },
       loop([last = Joints{}, total = Joints{}](std::size_t i, double x, double) mutable {
         total[i] += x - last[i], last[i] = x;
         return total[i] / 4096;
       })},
  };
}

void six_quintics(std::uint64_t n) {
  static library::Motion y[kJoints];
  library::Quintic path{0, 1, 3600};
  for (double t = 0; n > 0; --n, t += 1e-3) {
    bench::keep(path);
    for (auto& motion : y) motion = path.at(t);
    bench::keep(y);
  }
}

/// Rows 10 ms apart, looked at every millisecond.
void between_rows(std::uint64_t n) {
  static const std::vector<Joints> rows(1001, Joints{1, 2, 3, 4, 5, 6});
  static Joints y{};
  for (double t = 0; n > 0; --n, t = t < 9.99 ? t + 1e-3 : 0) {
    const double at = t / 1e-2, share = at - std::floor(at);
    const auto row = static_cast<std::size_t>(at);
    for (std::size_t i = 0; i < kJoints; ++i) y[i] = rows[row][i] + share * (rows[row + 1][i] - rows[row][i]);
    bench::keep(y);
  }
}

std::vector<ComponentCase> joint_cases() {
  return {
      {"pid_joint", "6 PID, direct", [](BenchRig& r) { r.set("ndof", static_cast<std::int32_t>(kJoints));
         for (const char* p : {"q_ref", "qd_ref", "q", "qd", "kp", "ki", "kd", "tau_max"}) fill(r, p, 0.5);
         r.set("filter_time", 0.002); },
       loop(PidLaw{})},
      {"pid", "6 PID, direct", [](BenchRig& r) {
         for (const char* p : {"reference", "measured", "kp", "ki", "kd", "low", "high"}) fill(r, p, 0.5);
         fill(r, "low", -1), r.set("filter_time", 0.002); },
       loop(PidLaw{})},
      {"servo_axis", "6 axes, direct", [](BenchRig& r) { r.set("ndof", static_cast<std::int32_t>(kJoints));
         fill(r, "inertia", 0.5), fill(r, "viscous", 0.1), fill(r, "tau", 0.3); },
       loop(AxisLaw{})},
      {"joint_trajectory", "6 quintics", [](BenchRig& r) { give_motion(r, "quintic"); },
       six_quintics},
      {"joint_trajectory", "jerk; 6 quintics", [](BenchRig& r) { give_motion(r, "jerk"); },
       six_quintics},
      {"csv_player", "6 lines between rows", [](BenchRig& r) {
         r.instances("out", 1), r.joined("out", "q", "1", 0), r.resource("file", "row_19.csv");
         r.set("is_repeated", true), r.set("is_interpolated", true); },
       between_rows},
  };
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  using namespace chimera;
  const bench::Stage stage;
  {
    std::ofstream file("row_19.csv");
    file << "t,q[0],q[1],q[2],q[3],q[4],q[5]\n";
    for (int i = 0; i <= 1000; ++i) file << i * 1e-2 << ",1,2,3,4,5,6\n";
  }
  int worst = 0;
  for (const auto& cases : {signal_cases(), block_cases(), other_cases(), joint_cases()})
    worst = std::max(worst, bench::measure(19, cases, argc, argv));
  std::remove("row_19.csv");
  return worst;
}
