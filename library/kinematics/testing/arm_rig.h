// SPDX-License-Identifier: Apache-2.0
// For tests of components that read the geometry of the arm: a Puma 560 at their ports.
#pragma once

#include <limits>
#include <span>
#include <string>

#include "chimera/task/rig.h"
#include "library/kinematics/puma560.h"

namespace chimera::library {

inline constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
inline constexpr Puma560::Vector kBent{0.3, 0.8, -2.5, 0.4, 0.8, -0.2};  ///< rad: far from every singular pose

struct ArmRig : Rig {
  using Rig::Rig;

  /// Sets the constants of the generic components.
  void build_puma() {
    set("ndof", std::int32_t{6});
    for (std::size_t i = 0; i < 6; ++i) set("dh", Puma560::kRows[i], i);
  }
  void give(const char* port, std::span<const double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) set(port, values[i], i);
  }
  void give_jacobian(const Jacobian& jacobian, std::size_t ndof) {
    for (std::size_t i = 0; i < ndof; ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        set("jv", jacobian.linear[i][r], ndof * r + i);
        set("jw", jacobian.angular[i][r], ndof * r + i);
      }
    }
  }
  Puma560::Vector six(const char* port) {
    Puma560::Vector found;
    for (std::size_t i = 0; i < 6; ++i) found[i] = get<double>(port, i);
    return found;
  }
  Frame pose(const char* port) { return frame_of(get<Pose>(port)); }
  /// Returns true if `output` holds under the illegal-configuration flag for any wanted value. The flag stays up.
  bool stands_while_illegal(const char* output) {
    if (!cycle()) return false;
    const Puma560::Vector stands = six(output);
    set("xr", Pose{{kNotANumber, 0, 0}, {1, 0, 0, 0}});
    illegal(true);
    return cycle() && six(output) == stands;
  }
  /// Text of the refusal of init or cycle; "accepted" without one.
  std::string refusal() {
    RigAnswer answer = init();
    if (answer) answer = cycle();
    return answer ? "accepted" : answer.text;
  }
};

inline double distance(const Frame& a, const Frame& b) {
  const Vec6 e = motion_between(a, b);
  return std::max(length({e[0], e[1], e[2]}), length({e[3], e[4], e[5]}));
}

}  // namespace chimera::library
