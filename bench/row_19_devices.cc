// SPDX-License-Identifier: Apache-2.0
// Row 19: one cycle of each component that speaks to a device, a disk or a terminal. What speaks in its cycle stands
// beside the bare system calls for the same bytes, the other end answering in the same loop; what speaks beside the
// cycles stands beside a copy of what crosses.
// Components: csv_log display tball serial_frame udp_frame modbus_io camera_targets visual_servo_interface
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include "bench/component.h"
#include "library/frame/frame.h"
#include "library/frame/values.h"
#include "library/vision/pinhole.h"
#ifdef CHIMERA_MODBUS
#include <modbus/modbus.h>

#include "library/modbus_io/modbus_line.h"
#endif

namespace chimera {
namespace {

using bench::ComponentCase;
using library::ArmRig;

constexpr std::size_t kValues = 2;
constexpr char kRecording[] = "row_19_features.csv", kEvents[] = "row_19_ball.events";

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

void write_what_waits(ArmRig& rig) { rig.background(); }

/// The same with standard output closed to what is printed: that is where the figures go.
void print_what_waits(ArmRig& rig) {
  static const int figures = ::dup(STDOUT_FILENO), nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  std::fflush(stdout);
  ::dup2(nowhere, STDOUT_FILENO);
  rig.background();
  std::fflush(stdout);
  ::dup2(figures, STDOUT_FILENO);
}

std::vector<ComponentCase> to_people() {
  return {{"csv_log", "copy of a row of 7", [](ArmRig& rig) { give_six(rig), rig.resource("file", "/dev/null"); },
           copy_rows, write_what_waits, 9000},
          {"display", "copy of a row of 7", [](ArmRig& rig) { give_six(rig), rig.set("title", Text<32>("")); },
           copy_rows, print_what_waits, 60}};
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
    library::Triple ball{0.6, 0, 0.5};
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
    library::Triple ball;
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

/// Both ends of a line, and what goes over it in either direction.
struct Line {
  int ours = -1, device = -1;
  std::uint8_t frame[64] = {}, heard[512] = {};
  std::size_t size = 0;

  void make_frame(std::size_t number_bytes) {
    for (std::size_t i = 0; i < kValues; ++i)
      library::put_value(frame + 2 + number_bytes + 4 * i, library::Form::kFloat32, 0.5, 1);
    number(0, number_bytes);
    size = library::close_frame(frame, number_bytes + 4 * kValues);
  }
  void number(std::uint32_t n, std::size_t number_bytes) { library::put_bytes(frame + 2, n, number_bytes); }
  void say() {
    if (::write(device, frame, size) < 0) throw std::runtime_error("the device cannot speak");
  }
  /// What a program without components does: reads what there is, writes its frame.
  void bare() {
    [[maybe_unused]] const ssize_t got = ::read(ours, heard, sizeof heard);
    if (::write(ours, frame, size) < 0) throw std::runtime_error("the line is full");
  }
  void hear() { [[maybe_unused]] const ssize_t got = ::read(device, heard, sizeof heard); }
};

/// A pseudo terminal; `path` is our end.
Line pseudo_terminal(std::string& path) {
  Line line;
  line.device = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if ((::grantpt(line.device) | ::unlockpt(line.device)) != 0) throw std::runtime_error("no pseudo terminal");
  path = ::ptsname(line.device);
  line.ours = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  termios mode{};
  ::tcgetattr(line.ours, &mode);
  ::cfmakeraw(&mode);
  ::tcsetattr(line.ours, TCSANOW, &mode);
  line.make_frame(0);
  return line;
}

/// A socket on the loopback and its port.
int udp_socket(int& port) {
  const int made = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof here;
  if (::bind(made, reinterpret_cast<sockaddr*>(&here), size) != 0) throw std::runtime_error("no socket");
  ::getsockname(made, reinterpret_cast<sockaddr*>(&here), &size);
  port = ntohs(here.sin_port);
  return made;
}
void join(int socket, int port) {
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(static_cast<std::uint16_t>(port));
  there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket, reinterpret_cast<sockaddr*>(&there), sizeof there) != 0) throw std::runtime_error("no way");
}

/// Prints what an exchange of frames costs with a component at our end, beside the bare calls.
void exchange(const char* component, const char* law, ArmRig& rig, Line& bare, Line& line, std::size_t number_bytes) {
  rig.extent("m", kValues), rig.set("fields", static_cast<std::int32_t>(kValues)), rig.set("timeout", 3600.0);
  for (std::size_t i = 0; i < kValues; ++i) rig.set("command", 0.5, i);
  RigAnswer made = rig.init();
  if (made) made = rig.on();
  if (!made) throw std::runtime_error(made.text);
  bench::Comparison comparison(101);
  const auto raw = comparison.add(law, [&](std::uint64_t n) {
    for (; n > 0; --n) bare.say(), bare.bare(), bare.hear();
  });
  std::uint32_t sent = 0;
  const auto ours = comparison.add(component, [&](std::uint64_t n) {
    for (; n > 0; --n) {
      line.number(++sent, number_bytes);
      library::close_frame(line.frame, line.size - library::kFrameOverhead);
      line.say();
      if (!bench::cycles(rig, 1)) throw std::runtime_error("a cycle failed");
      line.hear();
    }
  });
  comparison.run(raw);
  bench::print(bench::Figure{.row = 19, .what = std::string("cycle of ") + component}.of(comparison, ours));
  if (rig.get<std::int64_t>("received") < static_cast<std::int64_t>(sent) / 2)
    throw std::runtime_error(std::string(component) + " heard less than half of the frames");
}

void serial_and_udp() {
  {
    std::string path, other;
    Line bare = pseudo_terminal(path), line = pseudo_terminal(other);
    ArmRig rig("serial_frame");
    rig.resource("device", other.c_str());
    exchange("serial_frame", "bare calls, pty", rig, bare, line, 0);
  }
  int ports[4];
  Line bare, line;
  bare.make_frame(4), line.make_frame(4);
  bare.device = udp_socket(ports[0]), bare.ours = udp_socket(ports[1]);
  join(bare.device, ports[1]), join(bare.ours, ports[0]);
  line.device = udp_socket(ports[2]);
  ::close(udp_socket(ports[3]));  // a port that is free
  join(line.device, ports[3]);
  ArmRig rig("udp_frame");
  rig.resource("device", ("127.0.0.1:" + std::to_string(ports[2])).c_str()), rig.set("local_port", ports[3]);
  exchange("udp_frame", "bare calls, loopback", rig, bare, line, 4);
}

#ifdef CHIMERA_MODBUS
/// A device in a process of its own, which libmodbus serves. Its port.
struct ModbusDevice {
  int port = 0;
  pid_t process = -1;

  ModbusDevice() {
    modbus_t* context = modbus_new_tcp("127.0.0.1", 0);
    int listening = modbus_tcp_listen(context, 1);
    sockaddr_in here{};
    socklen_t size = sizeof here;
    ::getsockname(listening, reinterpret_cast<sockaddr*>(&here), &size);
    port = ntohs(here.sin_port);
    process = ::fork();
    if (process == 0) serve(context, listening);
    ::close(listening);
    modbus_free(context);
  }
  ModbusDevice(const ModbusDevice&) = delete;
  ModbusDevice& operator=(const ModbusDevice&) = delete;
  ~ModbusDevice() {
    ::kill(process, SIGKILL);  // still ours: not reaped yet
    ::waitpid(process, nullptr, 0);
  }
  std::string name() const { return "tcp:127.0.0.1:" + std::to_string(port); }

 private:
  [[noreturn]] static void serve(modbus_t* context, int listening) {
    const sched_param none{.sched_priority = 0};
    ::sched_setscheduler(0, SCHED_OTHER, &none);
    modbus_mapping_t* map = modbus_mapping_new(16, 16, 16, 16);
    modbus_tcp_accept(context, &listening);
    std::uint8_t query[MODBUS_TCP_MAX_ADU_LENGTH];
    for (int got = 0; got >= 0;) {
      got = modbus_receive(context, query);
      if (got > 0) modbus_reply(context, query, got, map);
    }
    ::_exit(0);
  }
};

void give_points(ArmRig& rig, const std::string& device) {
  for (const char* port : {"input", "contact", "holding", "coil"}) rig.instances(port, 4);
  for (std::size_t i = 0; i < 4; ++i) rig.set("holding", 0.5, 0, i), rig.set("coil", false, 0, i);
  rig.set("holding_resolution", 0.01), rig.set("timeout", 3600.0), rig.resource("device", device.c_str());
}

void scale_points(std::uint64_t n) {
  double in[4]{}, out[4]{.1, .2, .3, .4};
  std::uint16_t told[4]{}, read[4]{1, 2, 3, 4};
  bool contact[4]{}, coil[4]{};
  for (; n > 0; --n) {
    bench::keep(out), bench::keep(read), bench::keep(coil);
    for (int i = 0; i < 4; ++i) {
      in[i] = static_cast<double>(static_cast<std::int16_t>(read[i]));
      told[i] = static_cast<std::uint16_t>(std::clamp(std::floor(out[i] / 0.01 + 0.5), -32768.0, 32767.0));
      contact[i] = coil[i];
    }
    bench::keep(in), bench::keep(told), bench::keep(contact);
  }
}

/// What is done beside the cycles, where libmodbus waits for the device: four requests.
void modbus_exchange() {
  const ModbusDevice one, other;
  ArmRig rig("modbus_io");
  give_points(rig, one.name());
  if (!rig.init() || !rig.on() || !rig.cycle()) throw std::runtime_error("modbus_io does not begin");
  modbus_t* line = modbus_new_tcp("127.0.0.1", other.port);
  if (modbus_connect(line) != 0) throw std::runtime_error("no connection");
  bench::Comparison comparison(31);
  const auto raw = comparison.add("libmodbus by itself", [line](std::uint64_t n) {
    std::uint16_t registers[4]{};
    std::uint8_t bits[4]{};
    for (; n > 0; --n) {
      modbus_write_registers(line, 0, 4, registers), modbus_write_bits(line, 0, 4, bits);
      modbus_read_input_registers(line, 0, 4, registers), modbus_read_input_bits(line, 0, 4, bits);
    }
  });
  const auto ours = comparison.add("modbus_io", [&](std::uint64_t n) { for (; n > 0; --n) rig.background(); });
  comparison.run(raw);
  bench::print(bench::Figure{.row = 19, .what = "modbus_io: an exchange beside the cycles"}.of(comparison, ours));
  modbus_close(line), modbus_free(line);
}

bool modbus(int argc, char** argv) {
  const ModbusDevice device;
  const auto give = [&](ArmRig& rig) { give_points(rig, device.name()); };
  const std::vector<ComponentCase> cases = {{"modbus_io", "scaling of 4 and 4", give, scale_points}};
  const bool is_well = bench::measure(19, cases, argc, argv) == 0;
  modbus_exchange();
  return is_well;
}
#else
bool modbus(int, char**) {
  std::fprintf(stderr, "row 19: modbus_io is not measured: libmodbus-dev was not found\n");
  return true;
}
#endif

/// What a camera sees for 400 s, and a ball whose six axes are pushed and stay so.
void record() {
  std::ofstream features(kRecording), events(kEvents);
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
  try {
    for (const auto& cases : {to_people(), of_sight()}) is_well = bench::measure(19, cases, argc, argv) == 0 && is_well;
    serial_and_udp();
    is_well = modbus(argc, argv) && is_well;
  } catch (const std::exception& wrong) {
    std::fprintf(stderr, "row 19: %s\n", wrong.what());
    is_well = false;
  }
  std::remove(kRecording), std::remove(kEvents);
  return is_well ? 0 : 1;
}
