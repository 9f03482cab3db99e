// SPDX-License-Identifier: Apache-2.0
// A ball with six degrees of freedom with which a person moves a reference. README.md is the data sheet.
#include <stdexcept>

#include "chimera/base/math.h"
#include "chimera/task/component.h"
#include "chimera/task/geometry.h"
#include "library/device/sentence.h"
#include "library/tball/ball_source.h"

using namespace chimera;
using namespace chimera::library;

namespace {

constexpr double kLongestStep = 0.1;  // s; a longer step moves the reference only by this time

struct TrackBall {
  Many<In<Pose>, 1> xm{"xm*", "1", frame = "base", doc = "Measured tool pose, for on; may be left out."};
  Out<Pose> xd{"xd", frame = "base", initial = Pose{{0, 0, 0}, {1, 0, 0, 0}}, doc = "Cartesian reference."};
  Out<double[6]> motion{"motion", "U", initial = 0.0,
                        doc = "Deflection times scale: along and about x y z, or of six joints."};
  Out<std::int32_t> buttons{"buttons", "1", initial = 0, doc = "A bit for each button that is pressed."};
  InConst<double[6]> scale{"scale", "U", initial = 1.0, range(-1e6, 1e6), doc = "Motion at full deflection."};
  InConst<double> linear{"linear", "m/s", initial = 0.1, range(0, 10), doc = "Speed of xd at full deflection."};
  InConst<double> angular{"angular", "rad/s", initial = 0.5, range(0, 10),
                          doc = "Turning speed of xd at full deflection."};
  InConst<std::int32_t> full{"full", "1", initial = 350, range(1, 1000000),
                             doc = "Counts of the device at full deflection."};
  InConst<double> hold{"hold", "s", initial = 0.2, range(0.001, 10),
                       doc = "Silence after which an axis or key counts as released."};
  Resource device{"device", safe_state, doc = "Input device, FIFO of its events, terminal (its keys), or recording."};

  void init() {
    source_.open(device.c_str());
    lost_.set(device.text(), "is gone");
    reinit();
  }
  void reinit() {
    if (*full < 1) throw std::runtime_error("full must be at least 1");
    ball_.reset(*full, from_seconds(*hold));
  }
  Outcome on(Cycle c) {
    is_gone_ = false;
    reinit();
    source_.start(c.now());
    rest();
    stood_ = false;
    if (xd.is_handed_over() && is_sound(*xd)) return ok();  // bumpless: the reference continues
    if (xm.size() > 0 && xm[0].valid() && !is_sound(*xm[0]))
      return fault("xm is not finite or no orientation: xd cannot start there");
    begin();
    return ok();
  }
  Outcome cycle(Cycle c) {
    if (is_gone_) return fault(lost_.text(), source_.error());
    // If the device is gone, one cycle publishes a ball at rest for all readers; the next cycle is a fault.
    is_gone_ = !source_.collect(ball_, *full, c.now());
    if (is_gone_) ball_.rest();
    double deflection[kBallAxes];
    for (std::size_t i = 0; i < kBallAxes; ++i) {
      deflection[i] = c.illegal() ? 0 : ball_.deflection(i, c.now());
      motion[i] = scale[i] * deflection[i];
    }
    *buttons = is_gone_ ? 0 : ball_.buttons();
    if (!c.illegal() && stood_) begin();  // the arm held itself while the flag was up
    stood_ = c.illegal();
    move(deflection, c.dt() < kLongestStep ? c.dt() : kLongestStep);
    return ok();
  }
  void off() {
    ball_.rest();
    rest();
  }
  bool clear() {
    source_.reopen();
    return true;
  }
  void kill() { source_.close(); }

 private:
  /// At the tool, if it is measured.
  void begin() {
    if (xm.size() > 0 && xm[0].valid() && is_sound(*xm[0])) *xd = *xm[0];
  }
  void rest() {
    for (double& m : motion) m = 0;
    *buttons = 0;
  }
  static Nanoseconds from_seconds(double s) { return {static_cast<std::int64_t>(s * 1e9)}; }

  static bool is_sound(const Pose& pose) {
    double norm = 0;
    for (const double p : pose.position)
      if (!math::is_finite(p)) return false;
    for (const double q : pose.orientation) norm += q * q;
    return norm > 0.5 && norm < 2;  // false for NaN
  }

  // Moves xd along and about the axes of its frame.
  void move(const double (&deflection)[kBallAxes], double dt) {
    Pose pose = *xd;
    for (std::size_t i = 0; i < 3; ++i) pose.position[i] += *linear * deflection[i] * dt;
    double half[3];
    double angle = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      half[i] = 0.5 * *angular * deflection[i + 3] * dt;
      angle += half[i] * half[i];
    }
    angle = math::sqrt(angle);
    if (angle > 0) turn(pose.orientation, half, angle);
    *xd = pose;
  }
  static void turn(double (&q)[4], const double (&half)[3], double angle) {
    const double s = math::sin(angle) / angle, w = math::cos(angle);
    const double x = s * half[0], y = s * half[1], z = s * half[2];
    const double r[4] = {w * q[0] - x * q[1] - y * q[2] - z * q[3], w * q[1] + x * q[0] + y * q[3] - z * q[2],
                         w * q[2] - x * q[3] + y * q[0] + z * q[1], w * q[3] + x * q[2] - y * q[1] + z * q[0]};
    const double norm = math::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int i = 0; i < 4; ++i) q[i] = r[i] / norm;
  }

  BallSource source_;
  Ball ball_;
  LostSentence lost_;
  bool is_gone_ = false;
  bool stood_ = false;  // the flag was up in the last cycle
};

CHIMERA_COMPONENT(TrackBall, "tball", "A ball with six degrees of freedom moves a reference.", rate = 100.0,
                  source = "2000 paper, table 1 and figure 9");

}  // namespace
