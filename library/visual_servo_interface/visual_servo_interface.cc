// SPDX-License-Identifier: Apache-2.0
// The interface to a visual servoing subsystem (1994 paper, figures 8 and 9): features in, desired tool pose out.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "library/kinematics/dh.h"
#include "library/vision/camera_ports.h"
#include "library/vision/feature_link.h"

using namespace chimera;

namespace {

struct VisualServoInterface : library::CameraPorts {
  In<Pose> xm{"xm", frame = "base", doc = "Measured tool pose."};
  Out<Pose> xd{"xd", frame = "base", doc = "Desired tool pose."};
  Out<Pose> target{"target", frame = "base", doc = "Tool pose at the ball."};
  Out<bool> in_sight{"in_sight", "1", initial = false, doc = "The last feature is younger than timeout."};
  Out<std::int64_t> received{"received", "1", initial = 0, doc = "Features with a valid place."};
  InConst<Pose> grip{"grip", initial = library::kIdentityPose, frame = "base",
                     doc = "Tool beside the ball: offset along the base's axes, orientation in the base."};
  InConst<double> gain{"gain", "1/s", initial = 5.0, range(0, 100), doc = "Rate at which xd approaches the target."};
  InConst<double> speed_limit{"speed_limit", "m/s", initial = 0.5, range(0, 10), doc = "Largest speed of xd."};
  InConst<double> turn_limit{"turn_limit", "rad/s", initial = 1.0, range(0, 10), doc = "Largest turning speed of xd."};
  InConst<double> timeout{"timeout", "s", initial = 0.3, range(0.001, 60),
                          doc = "Time without a feature after which xd holds."};
  Resource link{"link", safe_state, shared, doc = "udp:ADDRESS:PORT, unix:PATH, here:NAME or file:PATH."};

  void init() {
    reinit();
    const Result<void> opened = reader_.open(link.c_str());
    if (!opened) throw std::runtime_error(std::string(opened.error().message.view()));
  }
  void reinit() { pinhole_ = pinhole(); }
  Outcome on(Cycle c) {
    if (!xm.valid()) return fault("xm was never written: where the tool is is not known");
    if (!is_finite(*xm)) return fault("xm is not a number");
    *target = *xm;
    if (!xd.is_handed_over() || !is_finite(*xd)) *xd = *xm;  // otherwise bumpless: xd continues
    reader_.rewind();
    begin_ = c.now();
    stood_ = false;
    was_seen_ = *in_sight = false;
    velocity_ = {};
    return ok();
  }
  void cycle(Cycle c) {
    const double now = static_cast<double>((c.now() - begin_).count) * 1e-9;
    library::Feature feature;
    while (reader_.take(now, feature)) look(feature, now);
    *in_sight = was_seen_ && now - seen_at_ < *timeout;
    if (!c.illegal() && std::exchange(stood_, false) && is_finite(*xm)) *xd = *xm;  // the arm held itself
    stood_ = stood_ || c.illegal();
    if (!*in_sight || c.illegal()) return;
    aim(now - seen_at_);
    approach(c.dt());
  }
  void background() { reader_.drain(); }
  void kill() { reader_.close(); }

 private:
  using Vec3 = library::Vec3;

  static bool is_finite(const Pose& pose) {
    const library::Frame frame = library::frame_of(pose);
    return std::isfinite(library::length(frame.origin + frame.x));
  }

  // Between two pictures the ball is assumed to move with its last velocity.
  void look(const library::Feature& feature, double now) {
    Vec3 place;
    if (!pinhole_.locate(feature, place)) return;
    const double between = feature.time - seen_.time;
    const bool follows = was_seen_ && between > 1e-4 && between < *timeout;
    velocity_ = follows ? (1 / between) * (place - place_) : Vec3{};
    place_ = place;
    seen_ = feature;
    seen_at_ = now;
    was_seen_ = true;
    *received += 1;
  }
  void aim(double since) {
    for (std::size_t i = 0; i < 3; ++i) {
      target->position[i] = place_[i] + since * velocity_[i] + grip->position[i];
    }
    std::ranges::copy(grip->orientation, target->orientation);
  }
  void approach(double dt) {
    const double lead = *gain > 0 ? 1 : 0;  // otherwise xd would lag a moving ball by its speed over the gain
    Vec3 v;
    for (std::size_t i = 0; i < 3; ++i) v[i] = *gain * (target->position[i] - xd->position[i]) + lead * velocity_[i];
    const double speed = library::length(v), share = speed > *speed_limit ? *speed_limit / speed : 1;
    for (std::size_t i = 0; i < 3; ++i) xd->position[i] += share * v[i] * dt;
    const double angle = library::angle_between(xd->orientation, target->orientation);
    library::turn_towards(xd->orientation, target->orientation, std::min(*turn_limit, *gain * angle) * dt);
  }

  library::Pinhole pinhole_;
  library::FeatureReader reader_;
  library::Feature seen_;
  Vec3 place_{}, velocity_{};
  Nanoseconds begin_{};
  double seen_at_ = 0;
  bool was_seen_ = false;
  bool stood_ = false;  // the flag was up in the last cycle
};

CHIMERA_COMPONENT(VisualServoInterface, "visual_servo_interface", "Desired tool pose from a visual servoing subsystem.",
                  rate = 100.0, source = "1994 paper, section 3.4, figures 8 and 9");

}  // namespace
