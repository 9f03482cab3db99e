// SPDX-License-Identifier: Apache-2.0
// A camera without distortion that sees a ball: place and size of the ball in the picture.
#pragma once

#include <cmath>

#include "library/kinematics/frame.h"

namespace chimera::library {

/// Result of the vision subsystem for one picture.
struct Feature {
  double time = 0;      ///< s, on the clock of the sender
  double u = 0, v = 0;  ///< px, to the right and down from the corner
  double size = 0;      ///< px, diameter of the ball in the picture
};

/// Its frame: origin in the pinhole, x to the right, y down, z forward.
struct Pinhole {
  double focal_length = 800;          ///< px
  double width = 1280, height = 960;  ///< px; the optical axis meets the middle
  Frame place;                        ///< the camera's frame in the base frame
  double ball_diameter = 0.05;        ///< m

  /// Projects a ball at `point` (m, base frame). Returns false and writes nothing if it is outside the picture.
  bool project(const Vec3& point, Feature& feature) const noexcept {
    const Vec3 seen = place.inverse_rotate(point - place.origin);
    if (!(seen[2] > ball_diameter)) return false;
    const double u = width / 2 + focal_length * seen[0] / seen[2], v = height / 2 + focal_length * seen[1] / seen[2];
    if (!(u >= 0 && u <= width && v >= 0 && v <= height)) return false;
    feature.u = u;
    feature.v = v;
    feature.size = focal_length * ball_diameter / seen[2];
    return true;
  }
  /// Finds the place of the ball (m, base frame). Returns false if the numbers belong to no picture.
  bool locate(const Feature& feature, Vec3& point) const noexcept {
    if (!(feature.size > 0) || !std::isfinite(feature.size + feature.u + feature.v)) return false;
    const double depth = focal_length * ball_diameter / feature.size;
    point = place.origin + place.rotate({(feature.u - width / 2) * depth / focal_length,
                                         (feature.v - height / 2) * depth / focal_length, depth});
    return true;
  }
};

}  // namespace chimera::library
