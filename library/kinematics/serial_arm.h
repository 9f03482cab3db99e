// SPDX-License-Identifier: Apache-2.0
// Forward kinematics, Jacobian and damped inverse of any serial arm, from the constants of library/kinematics/dh.h.
// Sums over at most ten joints: no allocation, no unbounded loop.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "library/kinematics/dh_of_axes.h"

namespace chimera::library {

/// Tool motion by joint motion, along the axes of the base: linear in m/rad, angular in rad/rad.
struct Jacobian {
  std::array<Vec3, kMostJoints> linear{}, angular{};
};

/// Six numbers of a motion: linear, then angular.
using Vec6 = std::array<double, 6>;

/// A chain prepared for computation: terms that do not depend on the joints are computed once.
class SerialArm {
 public:
  SerialArm() = default;
  /// Context: setup.
  explicit SerialArm(const DhChain& chain) noexcept
      : joints_(chain.ndof), base_(frame_of(chain.base)), tool_(frame_of(chain.tool)) {
    for (std::size_t i = 0; i < joints_; ++i) {
      const DhLink& link = chain.dh[i];
      rows_[i] = {link.a, link.d, link.theta, std::cos(link.alpha), std::sin(link.alpha)};
    }
  }
  std::size_t joints() const noexcept { return joints_; }

  /// Tool frame in the base with the joints at `q` (rad, joints() numbers). Context: cycle; wait-free.
  Frame tool_frame(std::span<const double> q) const noexcept {
    Frame frame = base_;
    for (std::size_t i = 0; i < joints_; ++i) frame = rows_[i].next(frame, q[i]);
    return frame * tool_;
  }
  /// Tool frame in the base, and the Jacobian there. Context: cycle; wait-free.
  Frame tool_frame(std::span<const double> q, Jacobian& jacobian) const noexcept {
    Frame frame = base_;
    std::array<Vec3, kMostJoints> at;
    for (std::size_t i = 0; i < joints_; ++i) {
      at[i] = frame.origin;
      jacobian.angular[i] = frame.z;
      frame = rows_[i].next(frame, q[i]);
    }
    const Frame tool = frame * tool_;
    for (std::size_t i = 0; i < joints_; ++i) {
      jacobian.linear[i] = cross(jacobian.angular[i], tool.origin - at[i]);
    }
    return tool;
  }

 private:
  struct Row {
    double a, d, theta, cos_alpha, sin_alpha;

    /// Frame after the joint: f Rz(angle + theta) Tz(d) Tx(a) Rx(alpha).
    Frame next(const Frame& f, double angle) const noexcept {
      const double c = std::cos(angle + theta), s = std::sin(angle + theta);
      const Vec3 x = c * f.x + s * f.y, across = c * f.y - s * f.x;
      return {f.origin + a * x + d * f.z, x, cos_alpha * across + sin_alpha * f.z,
              cos_alpha * f.z - sin_alpha * across};
    }
  };

  std::size_t joints_ = 0;
  std::array<Row, kMostJoints> rows_{};
  Frame base_, tool_;
};

/// Turn from `from` to `to` as a vector: its direction is the axis, its length the angle (rad, at most pi).
inline Vec3 turn_between(const Frame& from, const Frame& to) noexcept {
  const Vec3 twice_sine = cross(from.x, to.x) + cross(from.y, to.y) + cross(from.z, to.z);
  const double cosine = (dot(from.x, to.x) + dot(from.y, to.y) + dot(from.z, to.z) - 1) / 2;
  const double sine = length(twice_sine) / 2;
  const double angle = std::atan2(sine, cosine);
  if (sine > 1e-9) return (angle / (2 * sine)) * twice_sine;
  if (cosine > 0) return {0, 0, 0};
  const Pose half = pose_of(Frame{
      {0, 0, 0}, from.inverse_rotate(to.x), from.inverse_rotate(to.y), from.inverse_rotate(to.z)});  // turned by pi
  return angle * from.rotate({half.orientation[1], half.orientation[2], half.orientation[3]});
}

/// Remaining motion from `is` to `wanted`: m and rad.
inline Vec6 motion_between(const Frame& is, const Frame& wanted) noexcept {
  const Vec3 way = wanted.origin - is.origin, turn = turn_between(is, wanted);
  return {way[0], way[1], way[2], turn[0], turn[1], turn[2]};
}

/// The least-squares inverse of a Jacobian that stays bounded near singular poses (Nakamura and Hanafusa 1986; Wampler
/// 1986): dq = J^T (J J^T + k I)^-1 e. k = damping^2 (1 - w/threshold)^2 if the manipulability w = sqrt(det J J^T) is
/// below the threshold; otherwise k only covers rounding. A radian counts as a metre.
class DampedInverse {
 public:
  double damping = 0.05;    ///< singular values below this are damped
  double threshold = 0.02;  ///< manipulability below which damping begins

  /// Computes the joint motion for the tool motion `e`; `dq` gets ndof numbers. Context: cycle; wait-free.
  void solve(const Jacobian& jacobian, std::size_t ndof, const Vec6& e, std::span<double> dq) noexcept {
    Matrix m = square(jacobian, ndof, 0);
    manipulability_ = factor(m) ? product_of_diagonal(m) : 0;
    const double short_of = std::max(0.0, 1 - manipulability_ / threshold);
    const double k = std::max(damping * damping * short_of * short_of, kLeast);
    m = square(jacobian, ndof, k);
    factor(m);
    const Vec6 y = substitute(m, e);
    for (std::size_t i = 0; i < ndof; ++i) {
      dq[i] = 0;
      for (std::size_t r = 0; r < 6; ++r) dq[i] += element(jacobian, r, i) * y[r];
    }
  }
  /// w of the last solve().
  double manipulability() const noexcept { return manipulability_; }

  static double element(const Jacobian& jacobian, std::size_t row, std::size_t joint) noexcept {
    return row < 3 ? jacobian.linear[joint][row] : jacobian.angular[joint][row - 3];
  }

 private:
  using Matrix = std::array<Vec6, 6>;
  static constexpr double kLeast = 1e-10;

  static Matrix square(const Jacobian& jacobian, std::size_t ndof, double k) noexcept {
    Matrix m{};
    for (std::size_t r = 0; r < 6; ++r) {
      for (std::size_t c = 0; c <= r; ++c) {
        double sum = r == c ? k : 0;
        for (std::size_t i = 0; i < ndof; ++i) sum += element(jacobian, r, i) * element(jacobian, c, i);
        m[r][c] = sum;
      }
    }
    return m;
  }
  /// Cholesky factor in place, lower half. Returns false if the matrix is not positive definite; it is then invalid.
  static bool factor(Matrix& m) noexcept {
    for (std::size_t r = 0; r < 6; ++r) {
      for (std::size_t c = 0; c <= r; ++c) {
        double sum = m[r][c];
        for (std::size_t k = 0; k < c; ++k) sum -= m[r][k] * m[c][k];
        if (r != c) m[r][c] = sum / m[c][c];
        else if (sum > 1e-14) m[r][r] = std::sqrt(sum);
        else return false;
      }
    }
    return true;
  }
  static double product_of_diagonal(const Matrix& m) noexcept {
    double product = 1;
    for (std::size_t r = 0; r < 6; ++r) product *= m[r][r];
    return product;
  }
  static Vec6 substitute(const Matrix& m, Vec6 e) noexcept {
    for (std::size_t r = 0; r < 6; ++r) {
      for (std::size_t c = 0; c < r; ++c) e[r] -= m[r][c] * e[c];
      e[r] /= m[r][r];
    }
    for (std::size_t r = 6; r-- > 0;) {
      for (std::size_t c = r + 1; c < 6; ++c) e[r] -= m[c][r] * e[c];
      e[r] /= m[r][r];
    }
    return e;
  }

  double manipulability_ = 0;
};

/// Joint limits (rad); infinite by default.
struct JointLimits {
  std::array<double, kMostJoints> low, high;
  JointLimits() noexcept {
    low.fill(-std::numeric_limits<double>::infinity());
    high.fill(std::numeric_limits<double>::infinity());
  }
  double cut(std::size_t joint, double angle) const noexcept { return std::clamp(angle, low[joint], high[joint]); }
};

/// Finds joint positions for a tool pose from nearby ones: Newton's method with a DampedInverse. A joint that would
/// leave its limits holds, and the search continues with the others.
class PoseSearch {
 public:
  JointLimits limits;

  static constexpr int kMostSteps = 20;        ///< bound of the steps of solve()
  static constexpr double kLongestStep = 0.2;  ///< rad, largest step of a joint
  static constexpr double kNearEnough = 1e-9;  ///< m and rad

  /// Moves `q` so that the tool comes to `wanted`. `q` must be within the limits. Returns true if the error is within
  /// `tolerance` (m and rad); otherwise `q` is the nearest found. Context: cycle; wait-free.
  bool solve(const SerialArm& arm, const Frame& wanted, std::span<double> q, double tolerance) noexcept {
    std::array<double, kMostJoints> dq;
    Jacobian jacobian;
    for (steps_ = 0; steps_ < kMostSteps; ++steps_) {
      const Vec6 e = motion_between(arm.tool_frame(q, jacobian), wanted);
      residual_ = size_of(e);
      if (residual_ < kNearEnough) break;
      inverse_.solve(jacobian, arm.joints(), e, dq);
      if (hold(q, dq, jacobian)) inverse_.solve(jacobian, arm.joints(), e, dq);
      double largest = 0;
      for (std::size_t i = 0; i < arm.joints(); ++i) largest = std::max(largest, std::abs(dq[i]));
      const double share = largest > kLongestStep ? kLongestStep / largest : 1;
      for (std::size_t i = 0; i < arm.joints(); ++i) q[i] = limits.cut(i, q[i] + share * dq[i]);
    }
    residual_ = size_of(motion_between(arm.tool_frame(q), wanted));
    return residual_ <= tolerance;
  }
  /// Error at the end of the last solve(): the larger of metres and radians.
  double residual() const noexcept { return residual_; }
  /// Number of steps of the last solve(), 0 to kMostSteps.
  int steps() const noexcept { return steps_; }

 private:
  /// Removes joints from the Jacobian that stand at a limit and would leave it. Returns false if there is none.
  bool hold(std::span<const double> q, const std::array<double, kMostJoints>& dq, Jacobian& jacobian) const noexcept {
    bool has_held = false;
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (!(q[i] <= limits.low[i] && dq[i] < 0) && !(q[i] >= limits.high[i] && dq[i] > 0)) continue;
      jacobian.linear[i] = jacobian.angular[i] = {0, 0, 0};
      has_held = true;
    }
    return has_held;
  }
  static double size_of(const Vec6& e) noexcept {
    return std::max(length({e[0], e[1], e[2]}), length({e[3], e[4], e[5]}));
  }

  DampedInverse inverse_;
  double residual_ = 0;
  int steps_ = 0;
};

}  // namespace chimera::library
