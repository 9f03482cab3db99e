// SPDX-License-Identifier: Apache-2.0
// Adds up mass, centre and inertia of the bodies that move with each joint.
#include "library/mujoco/link_masses.h"

#include <mujoco/mujoco.h>

namespace chimera::library {
namespace {

/// The last joint of the arm between the world and `body`; ndof if there is none.
std::size_t joint_before(const mjModel* m, const ArmModel& arm, int body) {
  for (int b = body; b > 0; b = m->body_parentid[b]) {
    for (int dof = m->body_dofadr[b] + m->body_dofnum[b]; dof-- > m->body_dofadr[b];) {
      for (std::size_t i = 0; i < arm.ndof; ++i) {
        if (arm.dof[i] == dof) return i;
      }
    }
  }
  return arm.ndof;
}

/// Sums about the origin of a frame, along its axes.
struct Sums {
  double mass = 0;
  Vec3 moment{0, 0, 0};             // first moment of mass
  std::array<double, 6> inertia{};  // xx yy zz xy xz yz
};

constexpr std::size_t kRow[] = {0, 1, 2, 0, 0, 1}, kColumn[] = {0, 1, 2, 1, 2, 2};

/// Adds the inertia of a point mass at `place` about the origin. A negative mass subtracts it.
void add_point(double mass, const Vec3& place, std::array<double, 6>& inertia) {
  for (std::size_t e = 0; e < 6; ++e) {
    inertia[e] -= mass * place[kRow[e]] * place[kColumn[e]];
    if (e < 3) inertia[e] += mass * dot(place, place);
  }
}

void add_body(const mjModel* m, const mjData* d, int body, const Frame& frame, Sums& sums) {
  const double mass = m->body_mass[body];
  const mjtNum *p = d->xipos + 3 * body, *r = d->ximat + 9 * body;
  const Vec3 centre = frame.inverse_rotate(Vec3{p[0], p[1], p[2]} - frame.origin);
  sums.mass += mass;
  sums.moment = sums.moment + mass * centre;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 axis = frame.inverse_rotate(Vec3{r[k], r[3 + k], r[6 + k]});
    for (std::size_t e = 0; e < 6; ++e) {
      sums.inertia[e] += m->body_inertia[3 * static_cast<std::size_t>(body) + k] * axis[kRow[e]] * axis[kColumn[e]];
    }
  }
  add_point(mass, centre, sums.inertia);
}

LinkMass link_of(const Sums& sums, double rotor, double friction) {
  LinkMass link{sums.mass, {0, 0, 0}, {}, rotor, friction};
  std::array<double, 6> inertia = sums.inertia;
  if (sums.mass > 0) {
    const Vec3 centre = (1 / sums.mass) * sums.moment;
    for (std::size_t i = 0; i < 3; ++i) link.centre[i] = centre[i];
    add_point(-sums.mass, centre, inertia);
  }
  for (std::size_t e = 0; e < 6; ++e) link.inertia[e] = inertia[e];
  return link;
}

}  // namespace

std::array<LinkMass, kMostJoints> link_masses(const mjModel_* m, mjData_* d, const ArmModel& arm) {
  stand_at_zero(m, d);
  std::array<Frame, kMostJoints> frames;
  Frame frame = frame_of(arm.chain.base);
  for (std::size_t i = 0; i < arm.ndof; ++i) frames[i] = frame = frame * frame_of(arm.chain.dh[i], 0);
  std::array<Sums, kMostJoints> sums;
  for (int body = 1; body < m->nbody; ++body) {
    const std::size_t joint = joint_before(m, arm, body);
    if (joint < arm.ndof) add_body(m, d, body, frames[joint], sums[joint]);
  }
  std::array<LinkMass, kMostJoints> links{};
  for (std::size_t i = 0; i < arm.ndof; ++i) {
    links[i] = link_of(sums[i], m->dof_armature[arm.dof[i]], m->dof_damping[arm.dof[i]]);
  }
  return links;
}

}  // namespace chimera::library
