// SPDX-License-Identifier: Apache-2.0
// Row 19: one cycle of each component that uses a line. A component that sends in its cycle is compared with the bare
// system calls for its bytes, while the other end answers in this loop. A component that sends beside its cycles is
// compared with the law of its cycle, and its exchange with that of libmodbus.
// Components: serial_frame udp_frame terminal modbus_io
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "bench/component.h"
#include "library/frame/frame.h"
#include "library/frame/values.h"
#ifdef CHIMERA_MODBUS
#include <modbus/modbus.h>
#endif

namespace chimera {
namespace {

using bench::ComponentCase;
using library::ArmRig;

constexpr std::size_t kValues = 2;

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
  /// Cycle of a program without components: reads the bytes that are there and writes its frame.
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

/// A line without a key typed and without a picture that waits.
bool quiet_terminal(int argc, char** argv) {
  std::string path, other;
  const Line bare = pseudo_terminal(path);
  (void)pseudo_terminal(other);  // its device stays open
  const auto give = [&](ArmRig& rig) { rig.resource("device", other.c_str()); };
  const auto read = [&](std::uint64_t n) {
    std::uint8_t keys[16];
    for (; n > 0; --n) {
      ssize_t got = ::read(bare.ours, keys, sizeof keys);
      bench::keep(got);
    }
  };
  return bench::measure(19, {{"terminal", "read of a quiet line", give, read}}, argc, argv) == 0;
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
  for (const char* port : {"input", "contact", "holding", "coil", "holding_resolution"}) rig.instances(port, 4);
  for (const char* port : {"input_resolution", "idle"}) rig.instances(port, 0);
  for (std::size_t i = 0; i < 4; ++i) rig.set("holding", 0.5, 0, i), rig.set("coil", false, 0, i);
  for (std::size_t i = 0; i < 4; ++i) rig.set("holding_resolution", 0.01, 0, i);
  rig.set("timeout", 3600.0), rig.resource("device", device.c_str());
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

/// Measures the work beside the cycles: four requests, in which libmodbus waits for the device.
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

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  using namespace chimera;
  const bench::Stage stage;
  try {
    serial_and_udp();
    const bool is_well = quiet_terminal(argc, argv);
    return modbus(argc, argv) && is_well ? 0 : 1;
  } catch (const std::exception& wrong) {
    std::fprintf(stderr, "row 19: %s\n", wrong.what());
    return 1;
  }
}
