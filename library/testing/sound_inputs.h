// SPDX-License-Identifier: Apache-2.0
// For tests of every component of the library: valid values for any port.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "chimera/base/testing/tree_path.h"
#include "chimera/task/rig.h"

namespace chimera::library {

/// A valid resource for a port of a component.
inline std::string sound_resource(const std::string& component, const std::string& port) {
  const std::string library = source_path("library/");
  const std::map<std::string, std::string> kKnown{
      {"accel", "0:0 2:1"}, {"brake", "0:0 2:1"}, {"car", "0:0 200:0.06"}, {"electric_car", "0:0 200:0.06"},
      {"ccui", "0:0 2:100"}, {"camera_targets", "file:/dev/null"}, {"csv_log", "/dev/null"},
      {"csv_player", library + "csv_player/csv_player_example.csv"}, {"puma_torque", "puma560.xml"},
      {"mujoco_robot", library + "puma_torque/puma560.xml"}, {"rmms", library + "rmms/rmms_a.store"},
      {"mujoco_robot_torque", library + "puma_torque/puma560.xml"},
      {"mujoco_robot_velocity", library + "puma_torque/puma560.xml"},
      {"tball", library + "tball/wave.events"}, {"urdf_model", library + "urdf_model/puma560.urdf"},
      {"udp_frame", "127.0.0.1:9"}, {"visual_servo_interface", "here:nonsense"}};
  const auto known = kKnown.find(component);
  return known == kKnown.end() ? "/dev/null/" + port : known->second;
}

/// A number within the range of the port.
inline double sound_number(const chimera_port_decl& port) {
  if ((port.flags & CHIMERA_PORT_HAS_RANGE) == 0) return 0.5;
  return std::min(std::max({port.min, 0.5, port.type == CHIMERA_INT32 ? 1.0 : 0.0}), port.max);
}

/// All structs of the library but a line of a menu have only float64 members. The orientation of a pose starts with
/// element 3.
inline std::array<double, 64> sound_struct(const chimera_port_decl& port) {
  std::array<double, 64> numbers{};
  if (std::string_view(port.type_name) == "menu_item") {
    const std::int32_t digits = 1;
    auto* const bytes = reinterpret_cast<char*>(numbers.data());
    std::memcpy(bytes + port.fields[1].offset, "text", 4);  // its kind
    std::memcpy(bytes + port.fields[4].offset, &digits, sizeof digits);
    return numbers;
  }
  numbers.fill(0.1);
  if (std::string_view(port.type_name) == "Pose") numbers = {0.3, 0.2, 0.1, 1};
  return numbers;
}

/// Sets an element of up to 512 bytes.
template <std::size_t kWords = 1>
void put_bytes(Rig& rig, const chimera_port_decl& port, std::uint32_t e, std::uint32_t instance, const char* bytes) {
  if constexpr (kWords <= 128) {
    if (port.element_size != 4 * kWords) return put_bytes<kWords + 1>(rig, port, e, instance, bytes);
    struct alignas(4) Element { char bytes[4 * kWords]; } element;
    std::memcpy(element.bytes, bytes, sizeof element);
    rig.set(port.name, element, e, instance);
  } else {
    throw std::invalid_argument("an element of " + std::to_string(port.element_size) + " bytes");
  }
}

/// Sets an element of any type of number, or a truth value.
inline void put_number(Rig& rig, const chimera_port_decl& port, std::uint32_t e, std::uint32_t instance, double value) {
  const auto whole = [value](double most) { return std::isnan(value) ? 0 : std::clamp(value, -most, most); };
  switch (port.type) {
    case CHIMERA_BOOL: return rig.set(port.name, value > 0, e, instance);
    case CHIMERA_INT32: return rig.set(port.name, static_cast<std::int32_t>(whole(2147483647)), e, instance);
    case CHIMERA_INT64: return rig.set(port.name, static_cast<std::int64_t>(whole(9e18)), e, instance);
    case CHIMERA_FLOAT32: return rig.set(port.name, static_cast<float>(value), e, instance);
    default: return rig.set(port.name, value, e, instance);
  }
}

}  // namespace chimera::library
