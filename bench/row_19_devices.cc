// SPDX-License-Identifier: Apache-2.0
// Row 19: one cycle of each component that speaks to a person, a disk or a camera, beside its law or a copy of what
// crosses.
// Components: button csv_log display display_manager tball camera_targets visual_servo_interface
#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "bench/component.h"
#include "library/display_manager/menu_item.h"
#include "library/frame/frame.h"
#include "library/vision/pinhole.h"

namespace chimera {
namespace {

using bench::ComponentCase;
using library::ArmRig;

constexpr char kRecording[] = "row_19_features.csv", kEvents[] = "row_19_ball.events", kPin[] = "row_19.pin";

/// A row of time and six numbers into the next place of a ring.
void copy_rows(std::uint64_t n) {
  constexpr std::size_t kPlaces = 4096;
  static std::vector<std::array<double, 7>> ring(kPlaces);
  std::array<double, 6> x{1, 2, 3, 4, 5, 6};
  for (double t = 0; n > 0; --n, t += 1e-3) {
    bench::keep(x);
    auto& row = ring[n % kPlaces];
    row[0] = t;
    std::copy(x.begin(), x.end(), row.begin() + 1);
    bench::keep(row);
  }
}

void give_six(ArmRig& rig) {
  rig.instances("in", 1);
  for (std::size_t i = 0; i < 6; ++i) rig.set("in", 0.1 * static_cast<double>(i), i);
}

/// A screen of seven values, which stand.
void give_menu(ArmRig& rig) {
  rig.instances("shown", 7);
  for (const char* port : {"edited", "preset", "minimum", "maximum", "step"}) rig.instances(port, 0);
  rig.extent("screens", 1);
  rig.extent("items", 7);
  rig.set("screen", Text<32>("values"));
  for (std::uint32_t i = 0; i < 7; ++i) {
    rig.set("item", library::MenuItem{"value", "show", 0, static_cast<std::int32_t>(i), 6}, i);
    rig.set("shown", 0.1 * i, 0, i);
  }
}

/// Seven numbers as text into a picture of 8 rows of 32, which is compared with the one before.
void draw_seven(std::uint64_t n) {
  std::array<double, 7> x{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  char wanted[8][32] = {}, shown[8][32] = {};
  for (int changed = 0; n > 0; --n) {
    bench::keep(x);
    for (std::size_t i = 0; i < 7; ++i) std::snprintf(wanted[i + 1], 32, "value %25.6g", x[i]);
    for (std::size_t i = 0; i < 256; ++i) changed += wanted[i / 32][i % 32] != shown[i / 32][i % 32] ? 1 : 0;
    std::copy(&wanted[0][0], &wanted[0][0] + 256, &shown[0][0]);
    bench::keep(changed);
  }
}

void write_what_waits(ArmRig& rig) { rig.background(); }

/// Runs the background with standard output sent to /dev/null: standard output is for the figures.
void print_what_waits(ArmRig& rig) {
  static const int figures = ::dup(STDOUT_FILENO), nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  std::fflush(stdout);
  ::dup2(nowhere, STDOUT_FILENO);
  rig.background();
  std::fflush(stdout);
  ::dup2(figures, STDOUT_FILENO);
}

/// Reads the level of a pin, as a loop without components does.
void read_pin(std::uint64_t n) {
  static const int pin = ::open(kPin, O_RDONLY | O_CLOEXEC);
  char level = 0;
  for (; n > 0; --n) {
    if (::pread(pin, &level, 1, 0) != 1) throw std::runtime_error("the pin cannot be read");
    bench::keep(level);
  }
}

std::vector<ComponentCase> to_people() {
  return {{"csv_log", "copy of a row of 7", [](ArmRig& rig) { give_six(rig), rig.resource("file", "/dev/null"); },
           copy_rows, write_what_waits, 9000},
          {"display", "copy of a row of 7", [](ArmRig& rig) { give_six(rig), rig.set("title", Text<32>("")); },
           copy_rows, print_what_waits, 60},
          {"button", "pread of a byte", [](ArmRig& rig) { rig.resource("pin", kPin); }, read_pin},
          {"display_manager", "seven numbers as text", give_menu, draw_seven}};
}

/// The law of a ball: six deflections, a step and a turn of the reference.
void move_by_a_ball(std::uint64_t n) {
  double p[3]{}, q[4]{1, 0, 0, 0}, d[6]{.1, .2, .3, .1, .2, .3};
  for (; n > 0; --n) {
    bench::keep(d);
    for (int i = 0; i < 3; ++i) p[i] += 0.1 * d[i] * 1e-3;
    const double angle = 0.25e-3 * std::sqrt(d[3] * d[3] + d[4] * d[4] + d[5] * d[5]);
    const double s = 0.25e-3 * std::sin(angle) / angle, w = std::cos(angle), x = s * d[3], y = s * d[4], z = s * d[5];
    const double r[4] = {w * q[0] - x * q[1] - y * q[2] - z * q[3], w * q[1] + x * q[0] + y * q[3] - z * q[2],
                         w * q[2] - x * q[3] + y * q[0] + z * q[1], w * q[3] + x * q[2] - y * q[1] + z * q[0]};
    const double norm = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int i = 0; i < 4; ++i) q[i] = r[i] / norm;
    bench::keep(p), bench::keep(q);
  }
}

library::Pinhole camera() {
  library::Pinhole made;
  made.place = library::frame_of(Pose{{2, 0, 0.5}, {0.5, 0.5, -0.5, -0.5}});
  return made;
}

/// A ball on its path, seen by a camera; and from the picture back to a place that a tool follows.
void see(std::uint64_t n) {
  const library::Pinhole pinhole = camera();
  library::Feature feature;
  std::array<double, 3> hz{0.3, 0.31, 0.32};
  for (double t = 0; n > 0; --n, t += 1e-3) {
    library::Vec3 ball{0.6, 0, 0.5};
    bench::keep(hz);
    for (std::size_t i = 0; i < 3; ++i) ball[i] += 0.1 * std::sin(2 * std::numbers::pi * hz[i] * t);
    pinhole.project(ball, feature);
    bench::keep(feature);
  }
}
void follow(std::uint64_t n) {
  const library::Pinhole pinhole = camera();
  library::Feature feature{0, 640, 480, 28.5};
  Pose tool{{0.5, 0, 0.5}, {1, 0, 0, 0}};
  const double goal[4] = {0.8, 0.6, 0, 0};
  for (; n > 0; --n) {
    library::Vec3 ball;
    bench::keep(feature);
    pinhole.locate(feature, ball);
    for (std::size_t i = 0; i < 3; ++i) tool.position[i] += 5e-3 * (ball[i] - tool.position[i]);
    library::turn_towards(tool.orientation, goal, 1e-9);
    bench::keep(tool);
  }
}

void give_camera(ArmRig& rig) { rig.set("camera", Pose{{2, 0, 0.5}, {0.5, 0.5, -0.5, -0.5}}); }

std::vector<ComponentCase> of_sight() {
  return {{"tball", "step and turn", [](ArmRig& rig) {
             rig.instances("xm", 0), rig.resource("device", kEvents); }, move_by_a_ball},
          {"camera_targets", "path and picture", [](ArmRig& rig) {
             give_camera(rig), rig.resource("link", "file:/dev/null");
             const double centre[] = {0.6, 0, 0.5}, sway[] = {0.1, 0.1, 0.1}, hz[] = {0.3, 0.3, 0.3};
             rig.give("centre", centre), rig.give("amplitude", sway), rig.give("frequency", hz); },
           see, write_what_waits, 60},
          {"visual_servo_interface", "place, step and turn", [](ArmRig& rig) {
             give_camera(rig), rig.set("xm", Pose{{0.5, 0, 0.5}, {1, 0, 0, 0}}), rig.set("timeout", 60.0);
             rig.resource("link", (std::string("file:") + kRecording).c_str()); }, follow, {}, 2000}};
}

/// Writes two recordings of 400 s: features of a camera, and events of a ball whose six axes are pushed and held.
void record() {
  std::ofstream features(kRecording), events(kEvents);
  std::ofstream(kPin) << "0\n";
  features << "t,u,v,size\n";
  for (int i = 0; i < 8000; ++i) features << i * 0.05 << "," << 640 + i % 20 << ",480,28.5\n";
  for (int axis = 0; axis < 6; ++axis) events << "E: 0.000000 0003 000" << axis << " " << 50 * axis + 50 << "\n";
  events << "E: 0.000000 0000 0000 0\n";
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  using namespace chimera;
  const bench::Stage stage;
  record();
  bool is_well = true;
  for (const auto& cases : {to_people(), of_sight()}) is_well = bench::measure(19, cases, argc, argv) == 0 && is_well;
  std::remove(kRecording), std::remove(kEvents), std::remove(kPin);
  return is_well ? 0 : 1;
}
