// SPDX-License-Identifier: Apache-2.0
// Reads and writes the values of an input of the component under test, within the limits that its port declares.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "chimera/component_test/inputs.h"
#include "chimera/task/number_at.h"

namespace chimera::component_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The port of the task that reads operator variable `name`.
const ConfiguredPort* reader_of(const Configuration& configuration, std::string_view name) {
  for (const ConfiguredPort& port : configuration.tasks()[0].ports)
    if (port.kind == CHIMERA_IN_VAR && port.variable == name) return &port;
  return nullptr;
}

bool is_number(std::uint32_t type) { return type <= CHIMERA_FLOAT64; }

// Generated values lie in the declared range, cut to finite limits; without a range, around the value of the setup.
void set_limits(InputChannel& channel, const PortDescriptor& port) {
  const double spread = std::max(std::abs(channel.base), 0.5);
  const bool has_low = port.has_range && std::isfinite(port.min), has_high = port.has_range && std::isfinite(port.max);
  channel.declared_high = has_high ? port.max : kInfinity;
  channel.low = has_low ? port.min : has_high ? port.max - 2 * spread : channel.base - spread;
  channel.high = has_high ? port.max : has_low ? port.min + 2 * spread : channel.base + spread;
  if (channel.type == CHIMERA_BOOL) channel.low = 0, channel.high = 1;
  if (channel.type == CHIMERA_INT32) {
    channel.low = std::max(channel.low, static_cast<double>(INT32_MIN));
    channel.high = std::min(channel.high, static_cast<double>(INT32_MAX));
  }
}

std::string element(std::size_t i, std::size_t columns) {
  if (columns == 1) return "[" + std::to_string(i) + "]";
  return "[" + std::to_string(i / columns) + "][" + std::to_string(i % columns) + "]";
}

struct Maker {
  InputForm& form;

  void add(std::string name, std::string port_name, std::string unit, std::size_t offset, std::uint32_t type,
           const PortDescriptor& port) {
    InputChannel channel{std::move(name), std::move(port_name), std::move(unit), offset, type};
    channel.base = form.get(channel, form.base);
    set_limits(channel, port);
    form.channels.push_back(std::move(channel));
  }
  void add_fields(const std::string& name, const std::string& port_name, std::size_t at, const PortDescriptor& port) {
    for (const FieldDescriptor& field : port.fields) {
      if (!is_number(field.type)) continue;
      if (port.type_name == "Pose" && field.name == "orientation") form.quaternions.push_back(at + field.offset);
      for (std::uint32_t i = 0; i < field.count; ++i) {
        const std::string tail = "." + field.name + (field.count == 1 ? "" : "[" + std::to_string(i) + "]");
        add(name + tail, port_name + tail, field.unit, at + field.offset + i * field.size, field.type, port);
      }
    }
  }
};

}  // namespace

InputForm InputForm::of(const Configuration& configuration, const Descriptor& component) {
  InputForm form;
  const ApplicationSpec& spec = configuration.spec();
  for (const GivenSpec& given : spec.operators) {
    form.offsets.push_back(form.base.size());
    form.base.insert(form.base.end(), given.value.begin(), given.value.end());
    form.base.resize((form.base.size() + 7) / 8 * 8);
  }
  Maker maker{form};
  for (std::size_t o = 0; o < spec.operators.size(); ++o) {
    const GivenSpec& given = spec.operators[o];
    const ConfiguredPort* reader = reader_of(configuration, given.name);
    if (reader == nullptr) continue;
    const PortDescriptor& port = component.ports[reader->declared];
    const std::size_t count = given.value.size() / given.element_bytes;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string tail = count == 1 ? "" : element(i, given.extent[1].max);
      const std::size_t at = form.offsets[o] + i * given.element_bytes;
      const std::string name = std::string(given.name) + tail, port_name = reader->name + tail;
      if (given.type == CHIMERA_STRUCT)
        maker.add_fields(name, port_name, at, port);
      else if (is_number(given.type))
        maker.add(name, port_name, reader->unit, at, given.type, port);
    }
  }
  return form;
}

double InputForm::get(const InputChannel& channel, std::span<const std::byte> row) const noexcept {
  return number_at(channel.type, row.data() + channel.offset);
}

void InputForm::put(const InputChannel& channel, double value, std::span<std::byte> row) const noexcept {
  std::byte* to = row.data() + channel.offset;
  const auto write = [to]<class T>(T converted) { std::memcpy(to, &converted, sizeof converted); };
  const auto whole = [value]<class T>(T least) {
    const auto most = std::numeric_limits<T>::max();
    if (!(value > static_cast<double>(least))) return least;
    return value >= static_cast<double>(most) ? most : static_cast<T>(std::llround(value));
  };
  switch (channel.type) {
    case CHIMERA_BOOL:
      write(static_cast<std::uint8_t>(value > 0.5 ? 1 : 0));
      return;
    case CHIMERA_INT32:
      write(whole(std::numeric_limits<std::int32_t>::min()));
      return;
    case CHIMERA_INT64:
      write(whole(std::numeric_limits<std::int64_t>::min()));
      return;
    case CHIMERA_FLOAT32:
      write(static_cast<float>(value));
      return;
    default:
      write(value);
  }
}

}  // namespace chimera::component_test
