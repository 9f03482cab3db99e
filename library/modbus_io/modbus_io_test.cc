// SPDX-License-Identifier: Apache-2.0
// modbus_io and a device that libmodbus serves. The device of modbus_line_test.cc misbehaves.
#if __has_include(<modbus/modbus.h>)
#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

/// Memory of a device: 16 points of each kind, shared with its process.
struct Points {
  std::uint8_t coils[16], contacts[16];
  std::uint16_t holdings[16], inputs[16];
  int shown;  // of the holdings; the device refuses the others
};

/// A device in its own process, served by libmodbus.
class Device {
 public:
  Device() {
    points = static_cast<Points*>(
        ::mmap(nullptr, sizeof(Points), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    points->shown = 16;
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);  // still ours: not reaped yet
      ::waitpid(process_, nullptr, 0);
    }
    if (listening_ >= 0) ::close(listening_);
    if (master_ >= 0) ::close(master_);
    ::munmap(points, sizeof(Points));
  }
  std::string tcp() {
    modbus_t* context = modbus_new_tcp("127.0.0.1", 0);
    listening_ = modbus_tcp_listen(context, 1);
    sockaddr_in here{};
    socklen_t size = sizeof here;
    EXPECT_EQ(::getsockname(listening_, reinterpret_cast<sockaddr*>(&here), &size), 0);
    modbus_free(context);
    serve();
    return "tcp:127.0.0.1:" + std::to_string(ntohs(here.sin_port));
  }
  std::string rtu() {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    EXPECT_EQ(::grantpt(master_) | ::unlockpt(master_), 0);
    termios mode{};
    ::tcgetattr(master_, &mode);
    ::cfmakeraw(&mode);
    ::tcsetattr(master_, TCSANOW, &mode);
    const std::string path = ::ptsname(master_);
    serve();
    return "rtu:" + path;
  }
  // A stopped device keeps its connections and what it received, and answers all when it goes on.
  void stop() { ::kill(process_, SIGSTOP); }  // still ours: not reaped yet
  void go_on() { ::kill(process_, SIGCONT); }  // still ours

  Points* points;

 private:
  void serve() {
    process_ = ::fork();
    if (process_ != 0) return;
    modbus_mapping_t map{};
    map.nb_bits = map.nb_input_bits = map.nb_input_registers = map.nb_registers = 16;
    map.tab_bits = points->coils;
    map.tab_input_bits = points->contacts;
    map.tab_registers = points->holdings;
    map.tab_input_registers = points->inputs;
    for (;;) answer(map);
  }
  void answer(modbus_mapping_t& map) {
    modbus_t* context = master_ >= 0 ? modbus_new_rtu("/dev/none", 19200, 'E', 8, 1) : modbus_new_tcp("127.0.0.1", 0);
    modbus_set_slave(context, 1);
    if (master_ >= 0) modbus_set_socket(context, master_);
    else modbus_tcp_accept(context, &listening_);
    std::uint8_t query[MODBUS_TCP_MAX_ADU_LENGTH];
    for (;;) {
      const int size = modbus_receive(context, query);
      if (size < 0) break;
      map.nb_registers = points->shown;
      if (size > 0) modbus_reply(context, query, size, &map);
    }
    if (master_ < 0) modbus_close(context);
    modbus_free(context);
  }

  int listening_ = -1, master_ = -1;
  pid_t process_ = -1;
};

struct ModbusIoTest : ::testing::Test {
  Rig rig{"modbus_io"};
  Device device;

  ModbusIoTest() { points(2, 2, 2, 2); }
  void points(std::uint32_t inputs, std::uint32_t contacts, std::uint32_t holdings, std::uint32_t coils) {
    rig.instances("input", inputs);
    rig.instances("contact", contacts);
    rig.instances("holding", holdings);
    rig.instances("coil", coils);
    for (const char* port : {"input_resolution", "holding_resolution", "idle"}) rig.instances(port, 0);
  }
  void start(const std::string& where) {
    rig.resource("device", where.c_str());
    for (std::size_t i = 0; i < 2; ++i) {
      rig.set("holding", 0.0, 0, i);
      rig.set("coil", false, 0, i);
    }
    begin();
  }
  void begin() {
    RigAnswer made = rig.init();
    for (int i = 0; i < 20 && !made; ++i) made = rig.init();  // this process may have been delayed
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  /// Repeats until an exchange succeeds. After a failure each 20th call makes one.
  void exchange() {
    for (int i = 0; i < 400; ++i) {
      ASSERT_TRUE(rig.background());
      if (rig.clear()) return;
    }
    FAIL() << "no exchange";
  }
  void give_two(const char* port, double value) {
    rig.instances(port, 2);
    for (std::size_t i = 0; i < 2; ++i) rig.set(port, value, 0, i);
  }
  /// Until the first answer after `on` only `idle` is written.
  void hear() {
    ASSERT_TRUE(rig.cycle());
    exchange();
  }
  double input(std::size_t i) { return rig.get<double>("input", 0, i); }
  bool connected() { return rig.get<bool>("connected"); }

  void exchanges_all_kinds(const std::string& where) {
    device.points->inputs[3] = 0xFFFE;
    device.points->holdings[7] = 0x8000, device.points->holdings[8] = 0x4366;  // 230.5, the low word first
    device.points->contacts[1] = 1;
    rig.set("input_form", Text<256>("input:3 int16 holding:7 float32_low"));
    give_two("input_resolution", 0.5);
    give_two("holding_resolution", 0.1);
    rig.set("holding_form", Text<256>("int16 int32"));
    start(where);
    hear();
    rig.set("holding", 12.34, 0, 0);
    rig.set("holding", -0.2, 0, 1);
    rig.set("coil", true, 0, 1);
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(device.points->holdings[0], 0) << "a cycle does not access the device";
    exchange();
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(input(0), -1);
    EXPECT_EQ(input(1), 115.25);
    EXPECT_FALSE(rig.get<bool>("contact", 0, 0));
    EXPECT_TRUE(rig.get<bool>("contact", 0, 1));
    EXPECT_EQ(device.points->holdings[0], 123);
    EXPECT_EQ(device.points->holdings[1], 0xFFFF);
    EXPECT_EQ(device.points->holdings[2], 0xFFFE);
    EXPECT_EQ(device.points->coils[0], 0);
    EXPECT_EQ(device.points->coils[1], 1);
    EXPECT_TRUE(connected());
  }
  /// The device answers requests of before when the task may be on again.
  void comes_back(const std::string& where) {
    device.points->inputs[0] = 4;
    start(where);
    hear();
    ASSERT_TRUE(rig.cycle());
    device.stop();
    ASSERT_TRUE(rig.background());
    ASSERT_TRUE(rig.cycle(milliseconds(1000)));
    EXPECT_TRUE(connected());
    ASSERT_TRUE(rig.cycle(milliseconds(10)));
    EXPECT_FALSE(connected());
    EXPECT_EQ(input(0), 4);
    EXPECT_DOUBLE_EQ(rig.get<double>("age"), 1.01);
    EXPECT_EQ(rig.cycle().text, where + " does not answer: bring it back, then `clear` and `on`");
    EXPECT_EQ(rig.clear().text, where + " does not answer: bring it back, then `clear` and `on`");
    device.go_on();
    device.points->inputs[0] = 5;
    exchange();
    ASSERT_TRUE(rig.on());
    ASSERT_TRUE(rig.cycle());
    EXPECT_TRUE(connected());
    EXPECT_EQ(input(0), 5);
    device.stop();
    ASSERT_TRUE(rig.background());
    ASSERT_TRUE(rig.kill());
    device.points->inputs[0] = 6;
    device.go_on();
    begin();
    hear();
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(input(0), 6) << "after kill and spawn";
  }
};

TEST_F(ModbusIoTest, AllKindsAreExchangedOverTcp) { exchanges_all_kinds(device.tcp()); }
TEST_F(ModbusIoTest, AllKindsAreExchangedOverASerialLine) { exchanges_all_kinds(device.rtu()); }
TEST_F(ModbusIoTest, AMuteTcpDeviceIsAFaultAndComesBackByClearAndBySpawn) { comes_back(device.tcp()); }
TEST_F(ModbusIoTest, AMuteSerialDeviceIsAFaultAndComesBackByClearAndBySpawn) { comes_back(device.rtu()); }

TEST_F(ModbusIoTest, NothingIsWrittenBeforeOnAndIdleAtOff) {
  device.points->holdings[0] = 77;
  device.points->coils[0] = 1;
  give_two("idle", 5);
  start(device.tcp());
  EXPECT_EQ(device.points->holdings[0], 77);
  EXPECT_EQ(device.points->coils[0], 1);
  rig.set("holding", 9.0, 0, 0);
  rig.set("coil", true, 0, 0);
  hear();
  EXPECT_EQ(device.points->holdings[0], 5) << "no answer since `on`";
  EXPECT_EQ(device.points->coils[0], 0);
  ASSERT_TRUE(rig.cycle());
  exchange();
  EXPECT_EQ(device.points->holdings[0], 9);
  EXPECT_EQ(device.points->coils[0], 1);
  ASSERT_TRUE(rig.off());
  exchange();
  EXPECT_EQ(device.points->holdings[0], 5);
  EXPECT_EQ(device.points->coils[0], 0);
  ASSERT_TRUE(rig.kill());
}

TEST_F(ModbusIoTest, SaysThatIdleHasBeenWrittenSinceTheFlagIsUp) {
  start(device.tcp());
  hear();
  rig.set("holding", 9.0, 0, 0);
  ASSERT_TRUE(rig.cycle());
  exchange();
  EXPECT_EQ(device.points->holdings[0], 9);
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled")) << "no exchange since";
  exchange();
  EXPECT_EQ(device.points->holdings[0], 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("idled"));
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled"));
}

/// Writes the safe frames as the guard does after the death of the process.
void write_safe_frames(Rig& rig) {
  for (const std::uint32_t index : {0u, 1u}) {
    const auto& frame = rig.safe_frame(index);
    ASSERT_GE(frame.descriptor, 0);
    ::usleep(static_cast<useconds_t>(frame.pause.count / 1000));
    ASSERT_EQ(::write(frame.descriptor, frame.bytes, frame.size), static_cast<ssize_t>(frame.size));
  }
}

TEST_F(ModbusIoTest, TheSafeFramesWriteIdleOverASerialLine) {
  give_two("idle", 5);
  rig.set("holding_form", Text<256>("holding:2 int16"));
  start(device.rtu());
  device.points->holdings[2] = device.points->holdings[3] = 77;
  device.points->holdings[4] = 78;
  device.points->coils[0] = device.points->coils[1] = device.points->coils[2] = 1;
  write_safe_frames(rig);
  for (int i = 0; i < 60'000 && device.points->coils[1] != 0; ++i) ::usleep(1000);
  EXPECT_EQ(device.points->holdings[2], 5);
  EXPECT_EQ(device.points->holdings[3], 5);
  EXPECT_EQ(device.points->holdings[4], 78) << "not ours";
  EXPECT_EQ(device.points->coils[0], 0);
  EXPECT_EQ(device.points->coils[1], 0);
  EXPECT_EQ(device.points->coils[2], 1) << "not ours";
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.safe_frame(0).size, 0u);
}

TEST_F(ModbusIoTest, TheSafeFramesWriteIdleOverASecondConnection) {
  give_two("idle", 5);
  start(device.tcp());
  device.points->holdings[0] = device.points->holdings[1] = 77;
  device.points->coils[1] = 1;
  const int second = ::dup(rig.safe_frame(0).descriptor);
  const std::string bytes(reinterpret_cast<const char*>(rig.safe_frame(0).bytes), rig.safe_frame(0).size);
  ASSERT_EQ(rig.safe_frame(0).descriptor, rig.safe_frame(1).descriptor);
  ASSERT_EQ(::write(second, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  ASSERT_TRUE(rig.kill());  // ends the first connection: this device serves one at a time
  for (int i = 0; i < 60'000 && device.points->holdings[1] != 5; ++i) ::usleep(1000);
  EXPECT_EQ(device.points->holdings[0], 5);
  EXPECT_EQ(device.points->holdings[1], 5);
  ::close(second);
}

TEST_F(ModbusIoTest, NeverWritesANonFiniteNumberAndClampsToTheRegister) {
  rig.set("holding_form", Text<256>("int16 uint16"));
  start(device.tcp());
  hear();
  rig.set("holding", 7.0, 0, 0);
  rig.set("holding", 1e300, 0, 1);
  ASSERT_TRUE(rig.cycle());
  exchange();
  EXPECT_EQ(device.points->holdings[1], 65535);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    rig.set("holding", bad, 0, 0);
    ASSERT_TRUE(rig.cycle());
    exchange();
    EXPECT_EQ(device.points->holdings[0], 7);
  }
  EXPECT_EQ(rig.get<std::int64_t>("unsent"), 2);
  rig.set("holding", -1e300, 0, 0);
  rig.set("holding", -1.0, 0, 1);
  ASSERT_TRUE(rig.cycle());
  exchange();
  EXPECT_EQ(device.points->holdings[0], 0x8000);
  EXPECT_EQ(device.points->holdings[1], 0);
}

TEST_F(ModbusIoTest, RefusesAnUnknownDeviceOrOtherRegisters) {
  const auto answer = [this](const std::string& where) {
    rig.resource("device", where.c_str());
    return rig.init().text;
  };
  for (const std::string where : {"", "tcp:", "tcp:1.2.3.4", "tcp:host:502", "tcp:1.2.3.4:0", "rtu:ttyS0",
                                 "udp:1.2.3.4:5"})
    EXPECT_EQ(answer(where),
              "\"" + where + "\" is no Modbus device: \"tcp:192.168.0.7:502\" and \"rtu:/dev/ttyS0\" are");
  EXPECT_EQ(answer("rtu:/dev/ttyUSB99"),
            "rtu:/dev/ttyUSB99: No such file or directory: plug the device in, or name another under `resources`");
  const std::string where = device.tcp();
  const auto refused = [&](const char* points) {
    return where + ": refuses " + points + ": exception 2, illegal data address: see its registers and `unit`";
  };
  rig.set("input_form", Text<256>("input:15 int16"));
  EXPECT_EQ(answer(where), refused("input registers 15 to 16"));
  rig.set("input_form", Text<256>("holding:15 float32 input:0"));
  EXPECT_EQ(answer(where), refused("holding registers 15 to 16"));
  rig.set("input_form", Text<256>("int16 double"));
  EXPECT_EQ(answer(where).substr(0, 35), "`input_form`: \"double\" is no form: ");
  rig.set("input_form", Text<256>("input:0 int16"));
  rig.set("first_contact", std::int32_t{99});
  rig.instances("contact", 1);
  EXPECT_EQ(answer(where), refused("discrete input 99"));
  rig.instances("input_resolution", 1);
  rig.set("input_resolution", 1.0);
  EXPECT_EQ(answer(where), "give one `input_resolution` for each port, or none");
  points(0, 0, 0, 0);
  EXPECT_EQ(answer(where), "nothing is exchanged: name at least one input, contact, holding or coil");
}

TEST_F(ModbusIoTest, SaysWhichRegisterTheDeviceRefusesLater) {
  start(device.tcp());
  hear();
  ASSERT_TRUE(rig.cycle());
  device.points->shown = 1;
  ASSERT_TRUE(rig.background());
  const std::string refusal = "refuses holding registers 0 to 1: exception 2, illegal data address";
  EXPECT_EQ(rig.clear().text, refusal);
  EXPECT_EQ(rig.clear().code, 2);
  ASSERT_TRUE(rig.cycle(milliseconds(1010)));
  EXPECT_EQ(rig.cycle().text, refusal);
  device.points->shown = 16;
  exchange();
}

}  // namespace
}  // namespace chimera
#endif
