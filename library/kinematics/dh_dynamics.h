// SPDX-License-Identifier: Apache-2.0
// Torques for a motion of any serial arm: the recursive Newton-Euler equations (Luh, Walker and Paul 1980) in the
// frames of library/kinematics/dh.h.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>

#include "library/kinematics/dh_of_axes.h"

namespace chimera::library {

/// Mass properties of the link after a joint, in the link's Denavit-Hartenberg frame, and properties of the joint's
/// drive.
struct LinkMass {
  double mass;        ///< kg
  double centre[3];   ///< m, centre of mass
  double inertia[6];  ///< kg.m2 about the centre: xx yy zz xy xz yz
  double rotor;       ///< kg.m2, of the drive, seen from the joint
  double friction;    ///< N.m.s/rad, viscous, seen from the joint
};

/// The links of an arm in motion.
class ArmDynamics {
 public:
  ArmDynamics() = default;
  /// `links` has one element for each joint of `chain`. `gravity` (m/s2) is along the axes of the base. A `payload`
  /// (kg) is a point mass at the tool. Context: setup.
  ArmDynamics(const DhChain& chain, std::span<const LinkMass> links, const Vec3& gravity, double payload) noexcept
      : joints_(chain.ndof) {
    const Vec3 seen = frame_of(chain.base).inverse_rotate(gravity);
    upward_ = {-seen[0], -seen[1], -seen[2]};
    for (std::size_t i = 0; i < joints_; ++i) links_[i] = {chain.dh[i], links[i]};
    if (payload > 0) add(payload, frame_of(chain.tool).origin, links_[joints_ - 1].of);
  }

  /// Computes the torques (N.m) for the accelerations `qdd` (rad/s2) at `q` and `qd`: inertia, centrifugal and Coriolis
  /// torques, weight, rotors and viscous friction. All spans have one number for each joint. Context: cycle; wait-free.
  void torque(std::span<const double> q, std::span<const double> qd, std::span<const double> qdd,
              std::span<double> tau) const noexcept {
    std::array<Frame, kMostJoints> frames;  // each in the previous frame
    std::array<Load, kMostJoints> loads;
    Motion motion{{}, {}, upward_};
    for (std::size_t i = 0; i < joints_; ++i) {
      frames[i] = frame_of(links_[i].dh, q[i]);
      motion = behind(frames[i], motion, qd[i], qdd[i]);
      loads[i] = load(links_[i].of, motion);
    }
    Load carried{};
    for (std::size_t i = joints_; i-- > 0;) {  // moments about the joint, in the previous frame
      carried.force = carried.force + loads[i].force;
      carried.moment = carried.moment + loads[i].moment;
      const Vec3 force = frames[i].rotate(carried.force);
      carried = {force, frames[i].rotate(carried.moment) + cross(frames[i].origin, force)};
      tau[i] = carried.moment[2] + links_[i].of.rotor * qdd[i] + links_[i].of.friction * qd[i];
    }
  }

 private:
  struct Link {
    DhLink dh;
    LinkMass of;
  };
  struct Motion {
    Vec3 turn, turn_rate, acceleration;  // along the axes of the frame; acceleration of its origin
  };
  struct Load {
    Vec3 force, moment;  // about the origin of the frame
  };

  /// Motion of the next frame. It turns about the z axis of this frame, and its origin turns with it.
  static Motion behind(const Frame& next, const Motion& here, double speed, double speed_rate) noexcept {
    const Vec3 axis{0, 0, 1};
    const Vec3 turn = here.turn + speed * axis;
    const Vec3 turn_rate = here.turn_rate + speed_rate * axis + speed * cross(here.turn, axis);
    const Vec3 moved = here.acceleration + carried_round(turn, turn_rate, next.origin);
    return {next.inverse_rotate(turn), next.inverse_rotate(turn_rate), next.inverse_rotate(moved)};
  }
  /// Acceleration of a point that is fixed to a turning body.
  static Vec3 carried_round(const Vec3& turn, const Vec3& turn_rate, const Vec3& point) noexcept {
    return cross(turn_rate, point) + cross(turn, cross(turn, point));
  }
  static Load load(const LinkMass& link, const Motion& motion) noexcept {
    const Vec3 centre{link.centre[0], link.centre[1], link.centre[2]};
    const Vec3 moved = motion.acceleration + carried_round(motion.turn, motion.turn_rate, centre);
    const Vec3 force = link.mass * moved;
    const Vec3 spin = times(link.inertia, motion.turn);
    return {force, times(link.inertia, motion.turn_rate) + cross(motion.turn, spin) + cross(centre, force)};
  }
  static Vec3 times(const double (&inertia)[6], const Vec3& v) noexcept {
    const auto [xx, yy, zz, xy, xz, yz] = inertia;
    return {xx * v[0] + xy * v[1] + xz * v[2], xy * v[0] + yy * v[1] + yz * v[2], xz * v[0] + yz * v[1] + zz * v[2]};
  }
  /// Adds a point mass at `place` to `link` (parallel axes).
  static void add(double mass, const Vec3& place, LinkMass& link) noexcept {
    const double whole = link.mass + mass, reduced = link.mass * mass / whole;
    const Vec3 apart = place - Vec3{link.centre[0], link.centre[1], link.centre[2]};
    const double square = dot(apart, apart);
    for (std::size_t i = 0; i < 3; ++i) {
      link.inertia[i] += reduced * (square - apart[i] * apart[i]);
      link.centre[i] += mass / whole * apart[i];
    }
    link.inertia[3] -= reduced * apart[0] * apart[1];
    link.inertia[4] -= reduced * apart[0] * apart[2];
    link.inertia[5] -= reduced * apart[1] * apart[2];
    link.mass = whole;
  }

  std::size_t joints_ = 0;
  std::array<Link, kMostJoints> links_{};
  Vec3 upward_{0, 0, 0};  // weight as an upward acceleration of the base
};

}  // namespace chimera::library

template <>
struct chimera::Fields<chimera::library::LinkMass> {
  static constexpr const char* name = "LinkMass";
  static constexpr auto list = std::tuple{
      field("mass", "kg", &library::LinkMass::mass),           field("centre", "m", &library::LinkMass::centre),
      field("inertia", "kg.m2", &library::LinkMass::inertia), field("rotor", "kg.m2", &library::LinkMass::rotor),
      field("friction", "N.m.s/rad", &library::LinkMass::friction)};
};
