// SPDX-License-Identifier: Apache-2.0
// Simulates the vision subsystem: a ball moves before a camera, and its place in each picture is sent over a link.
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "library/vision/camera_ports.h"
#include "library/vision/feature_link.h"

using namespace chimera;

namespace {

struct CameraTargets : library::CameraPorts {
  Out<double[3]> ball{"ball", "m", frame = "base", doc = "Where the ball is."};
  Out<double[3]> feature{"feature", "1",
                         doc = "Place (right, down) and diameter in the picture, in pixels; 0 out of sight."};
  Out<bool> in_sight{"in_sight", "1", initial = false, doc = "The ball is in the picture."};
  Out<std::int64_t> sent{"sent", "1", initial = 0, doc = "Features sent."};
  InConst<double[3]> centre{"centre", "m", frame = "base", doc = "Middle of the path of the ball."};
  InConst<double[3]> amplitude{"amplitude", "m", initial = 0.0, range(0, 10), frame = "base", doc = "Along each axis."};
  InConst<double[3]> frequency{"frequency", "Hz", initial = 0.0, range(0, 10), doc = "Along each axis."};
  InConst<double[3]> phase{"phase", "rad", initial = 0.0, doc = "Along each axis."};
  InConst<double> noise{"noise", "1", initial = 0.0, range(0, 20), doc = "Largest error of a number, in pixels."};
  Resource link{"link", safe_state, shared, doc = "udp:ADDRESS:PORT, unix:PATH, here:NAME or file:PATH."};

  void init(Cycle c) {
    reinit();
    const Result<void> opened = writer_.open(link.c_str());
    if (!opened) throw std::runtime_error(std::string(opened.error().message.view()));
    if (!writer_.note().empty()) c.note(writer_.note().c_str());
  }
  void reinit() {
    pinhole_ = pinhole();
    for (const double number : {centre[0], centre[1], centre[2], phase[0], phase[1], phase[2]})
      if (!std::isfinite(number)) throw std::runtime_error("centre and phase must be finite");
  }
  void on(Cycle c) {
    begin_ = c.now();
    move(0);
  }
  void cycle(Cycle c) {
    const double t = static_cast<double>((c.now() - begin_).count) * 1e-9;
    move(t);
    library::Feature found;
    *in_sight = pinhole_.project({ball[0], ball[1], ball[2]}, found);
    if (*in_sight) {
      found = {t, found.u + off_by(), found.v + off_by(), found.size + off_by()};
      if (writer_.send(found)) *sent += 1;
    }
    feature[0] = found.u;
    feature[1] = found.v;
    feature[2] = found.size;
  }
  void background() { writer_.flush(); }
  void kill() { writer_.close(); }

 private:
  void move(double t) {
    for (std::size_t i = 0; i < 3; ++i) {
      ball[i] = centre[i] + amplitude[i] * std::sin(2 * std::numbers::pi * frequency[i] * t + phase[i]);
    }
  }
  // Errors of the picture. Every run has the same ones.
  double off_by() {
    random_ = random_ * 6364136223846793005u + 1442695040888963407u;
    return *noise * (static_cast<double>(random_ >> 11) * 0x1p-52 - 1);
  }

  library::Pinhole pinhole_;
  library::FeatureWriter writer_;
  Nanoseconds begin_{};
  std::uint64_t random_ = 1;
};

CHIMERA_COMPONENT(CameraTargets, "camera_targets", "Simulated vision: sends the features of a ball before a camera.",
                  rate = 30.0, source = "1994 paper, section 3.4: the visual servoing subsystem");

}  // namespace
