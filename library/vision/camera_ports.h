// SPDX-License-Identifier: Apache-2.0
// Constants of a calibrated camera, shared by its simulation and by its reader.
#pragma once

#include <cmath>
#include <stdexcept>

#include "chimera/task/component.h"
#include "library/vision/pinhole.h"

namespace chimera::library {

/// Base of a component with the in-consts of a camera.
struct CameraPorts {
  InConst<Pose> camera{"camera", frame = "base", doc = "The camera: x to the right, y down, z forward."};
  InConst<double> focal_length{"focal_length", "1", initial = 800.0, range(1, 1e5), doc = "Focal length in pixels."};
  InConst<double[2]> image_size{"image_size", "1", initial = {1280.0, 960.0}, range(1, 1e5),
                                doc = "Width and height in pixels; the optical axis meets the middle."};
  InConst<double> ball_diameter{"ball_diameter", "m", initial = 0.05, range(1e-3, 10), doc = "Diameter of the ball."};

 protected:
  Pinhole pinhole() const {
    const Pose& pose = *camera;
    double square = 0;
    for (double q : pose.orientation) square += q * q;
    for (double p : pose.position)
      if (!std::isfinite(p)) throw std::runtime_error("camera: the position is not finite");
    if (!(std::abs(square - 1) < 1e-6)) throw std::runtime_error("camera: the orientation is no unit quaternion");
    return {*focal_length, image_size[0], image_size[1], frame_of(pose), *ball_diameter};
  }
};

}  // namespace chimera::library
