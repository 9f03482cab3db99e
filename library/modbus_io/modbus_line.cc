// SPDX-License-Identifier: Apache-2.0
// Connects to a Modbus device by libmodbus, and reads and writes its registers.
#include "library/modbus_io/modbus_line.h"

#include <modbus/modbus.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

namespace chimera::library {
namespace {

constexpr std::uint32_t kAnswerMicroseconds = 200'000;

int port_of(const std::string& digits) {
  if (digits.empty() || digits.size() > 5 || digits.find_first_not_of("0123456789") != std::string::npos) return 0;
  return std::stoi(digits);
}

modbus_t* made_of(const ModbusPlan& plan) {
  const std::string where = plan.device.substr(plan.device.find(':') + 1);
  if (plan.device.starts_with("rtu:/")) return modbus_new_rtu(where.c_str(), plan.baud, 'E', 8, 1);
  const std::size_t colon = where.rfind(':');
  const int port = colon == std::string::npos ? 0 : port_of(where.substr(colon + 1));
  if (!plan.device.starts_with("tcp:") || port < 1 || port > 65535) return nullptr;
  const std::string address = where.substr(0, colon);
  if (address.empty() || address.find_first_not_of("0123456789.") != std::string::npos) return nullptr;
  return modbus_new_tcp(address.c_str(), port);
}

}  // namespace

void ModbusLine::plan(const ModbusPlan& plan) {
  close();
  plan_ = plan;
  context_ = made_of(plan);
  if (context_ == nullptr)
    throw std::runtime_error("\"" + plan.device +
                             "\" is no Modbus device: \"tcp:192.168.0.7:502\" and \"rtu:/dev/ttyS0\" are");
  modbus_set_slave(context_, plan.unit);
  modbus_set_response_timeout(context_, 0, kAnswerMicroseconds);
}

int ModbusLine::connect() noexcept {
  give_up_second();
  modbus_close(context_);
  return modbus_connect(context_) == 0 ? 0 : errno;
}

int ModbusLine::exchange(const ModbusCommand& command, ModbusReading& reading) noexcept {
  const ModbusPlan& p = plan_;
  const bool writes = command.number != 0;
  errno = 0;
  if (writes && p.holdings > 0 &&
      modbus_write_registers(context_, p.first_holding, p.holdings, command.holdings.data()) != p.holdings)
    return errno;
  if (writes && p.coils > 0 && modbus_write_bits(context_, p.first_coil, p.coils, command.coils.data()) != p.coils)
    return errno;
  if (p.inputs > 0 &&
      modbus_read_input_registers(context_, p.first_input, p.inputs, reading.inputs.data()) != p.inputs)
    return errno;
  if (p.contacts > 0 &&
      modbus_read_input_bits(context_, p.first_contact, p.contacts, reading.contacts.data()) != p.contacts)
    return errno;
  reading.command = command.number;
  return 0;
}

int ModbusLine::open_second() noexcept {
  if (!is_tcp()) return modbus_get_socket(context_);
  give_up_second();
  second_ = made_of(plan_);
  if (second_ == nullptr) return -1;
  modbus_set_response_timeout(second_, 0, kAnswerMicroseconds);
  if (modbus_connect(second_) == 0) return modbus_get_socket(second_);
  give_up_second();
  return -1;
}

void ModbusLine::give_up_second() noexcept {
  if (second_ == nullptr) return;
  modbus_close(second_);
  modbus_free(std::exchange(second_, nullptr));
}

void ModbusLine::close() noexcept {
  give_up_second();
  if (context_ == nullptr) return;
  modbus_close(context_);
  modbus_free(std::exchange(context_, nullptr));
}

const char* ModbusLine::text_of(int error) noexcept { return modbus_strerror(error); }

}  // namespace chimera::library
