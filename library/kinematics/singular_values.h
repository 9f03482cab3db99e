// SPDX-License-Identifier: Apache-2.0
// Singular values of a Jacobian, which show how near an arm is to a singular pose.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "library/kinematics/serial_arm.h"

namespace chimera::library {

/// The singular values of a Jacobian: tool motion by joint motion in the easiest and the hardest direction. One-sided
/// Jacobi rotations (Hestenes 1958) in a bounded number of sweeps; small values are exact to rounding.
class SingularValues {
 public:
  static constexpr int kMostSweeps = 12;  ///< convergence is quadratic: random and singular arms take up to 8

  /// `length` (m) makes linear and angular motion comparable: linear rows are divided by it. Context: cycle; wait-free.
  SingularValues(const Jacobian& jacobian, std::size_t ndof, double length = 1) noexcept
      : count_(std::min<std::size_t>(6, ndof)) {
    // Makes the fewer of rows and columns orthogonal to each other. Their lengths are the singular values.
    std::array<std::array<double, kMostJoints>, 6> rows{};
    for (std::size_t r = 0; r < 6; ++r) {
      const double scale = r < 3 ? 1 / length : 1;
      for (std::size_t i = 0; i < ndof; ++i) {
        (ndof < 6 ? rows[i][r] : rows[r][i]) = scale * DampedInverse::element(jacobian, r, i);
      }
    }
    for (sweeps_ = 0; sweeps_ < kMostSweeps; ++sweeps_) {
      if (!sweep(rows)) break;
    }
    for (std::size_t r = 0; r < count_; ++r) values_[r] = std::sqrt(product(rows[r], rows[r]));
  }
  /// The smallest value. It is 0 if the arm cannot move in one of the directions that its joints allow in general.
  double least() const noexcept { return *std::min_element(values_.begin(), values_.begin() + count_); }
  double greatest() const noexcept { return *std::max_element(values_.begin(), values_.begin() + count_); }
  /// Product of the values, Yoshikawa's manipulability:
  /// det J
  ///  of a square Jacobian.
  double manipulability() const noexcept {
    double product = 1;
    for (std::size_t r = 0; r < count_; ++r) product *= values_[r];
    return product;
  }
  /// Returns false if a number of the Jacobian is NaN, infinite or above 1e150.
  bool are_finite() const noexcept {
    double sum = 0;
    for (const double value : values_) sum += value;
    return std::isfinite(sum);
  }
  /// Number of sweeps; kMostSweeps if they did not suffice.
  int sweeps() const noexcept { return sweeps_; }

 private:
  using Row = std::array<double, kMostJoints>;

  static double product(const Row& a, const Row& b) noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < kMostJoints; ++i) sum += a[i] * b[i];
    return sum;
  }
  /// Turns every pair of rows until they are orthogonal. Returns false if all pairs were.
  bool sweep(std::array<Row, 6>& rows) const noexcept {
    bool has_turned = false;
    for (std::size_t r = 0; r + 1 < count_; ++r) {
      for (std::size_t s = r + 1; s < count_; ++s) has_turned = turn(rows[r], rows[s]) || has_turned;
    }
    return has_turned;
  }
  static bool turn(Row& a, Row& b) noexcept {
    const double aa = product(a, a), bb = product(b, b), ab = product(a, b);
    if (!(std::abs(ab) > 1e-15 * std::sqrt(aa * bb)) || std::abs(ab) < 1e-200) return false;
    const double cotangent = (bb - aa) / (2 * ab);  // of the double angle
    const double t = (cotangent < 0 ? -1 : 1) / (std::abs(cotangent) + std::sqrt(1 + cotangent * cotangent));
    const double c = 1 / std::sqrt(1 + t * t), s = c * t;
    for (std::size_t i = 0; i < kMostJoints; ++i) {
      const double was = a[i];
      a[i] = c * was - s * b[i];
      b[i] = s * was + c * b[i];
    }
    return true;
  }

  std::size_t count_;
  std::array<double, 6> values_{};
  int sweeps_ = 0;
};

}  // namespace chimera::library
