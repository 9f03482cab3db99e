// SPDX-License-Identifier: Apache-2.0
// Any bytes as an image: refused with a reason, or an application that holds together and is written back as it was.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "chimera/base/testing/property.h"
#include "chimera/runtime/hosted/application_image.h"

namespace {

using namespace chimera;

/// The bytes behind a header that is right: otherwise the hash would refuse nearly everything.
std::vector<std::byte> with_header(const std::uint8_t* bytes, std::size_t size) {
  const std::uint64_t magic = 0x31474d49'4d494843, total = size + 32;
  const std::uint32_t version = 9, header_bytes = 32;
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  std::vector<std::byte> image(total);
  std::memcpy(image.data(), &magic, 8);
  std::memcpy(image.data() + 8, &version, 4);
  std::memcpy(image.data() + 12, &header_bytes, 4);
  std::memcpy(image.data() + 16, &total, 8);
  std::memcpy(image.data() + 24, &hash, 8);
  if (size > 0) std::memcpy(image.data() + 32, bytes, size);
  return image;
}

unsigned sum(std::span<const std::byte> bytes) {
  unsigned all = 0;
  for (const std::byte b : bytes) all += static_cast<unsigned char>(b);
  return all;
}

unsigned sum(std::string_view text) { return sum(std::as_bytes(std::span(text.data(), text.size()))); }

/// Ports number `port.index` of a kind exist and are linked to what lists them.
void check_ports(const ApplicationSpec& spec, std::span<const PortOf> ports, std::uint32_t kind, VariableId variable,
                 ConstantId constant) {
  for (const PortOf& port : ports) {
    const PortSpec* found = spec.port(kind, port);
    require(found != nullptr && found->variable == variable && found->constant == constant, "links hold both ways");
  }
}

unsigned check_links(const ApplicationSpec& spec) {
  unsigned all = 0;
  for (std::size_t v = 0; v < spec.variables.size(); ++v) {
    const Variable& variable = spec.variables[v];
    require(!variable.is_given() || variable.operator_index < spec.operators.size(),
            "operators exist");
    check_ports(spec, variable.producers, CHIMERA_OUT_VAR, VariableId(v), {});
    check_ports(spec, variable.consumers, CHIMERA_IN_VAR, VariableId(v), {});
    all += sum(variable.name);
  }
  for (std::size_t c = 0; c < spec.constants.size(); ++c) {
    check_ports(spec, spec.constants[c].producers, CHIMERA_OUT_CONST, {}, ConstantId(c));
    all += sum(spec.constants[c].name) + sum(spec.constants[c].value);
  }
  return all;
}

/// Touches everything it points at.
unsigned check_spec(const ApplicationSpec& spec) {
  unsigned all = sum(spec.name);
  for (const TaskSpec& task : spec.tasks) {
    require(task.rtpu.index < spec.rtpus.size(), "every task has an rtpu");
    require(task.deadline.count > 0 && task.deadline <= task.period, "times are in order");
    all += sum(task.name) + sum(task.component);
    for (const PortSpec& port : task.ports) {
      require(port.element_bytes == 0 || port.value.empty() || port.value.size() == port.max_bytes(),
              "values fill their ports");
      require(port.max_step.empty() || port.max_step.size() == port.max_bytes(), "largest steps fill their ports");
      all += sum(spec.link_name(port)) + sum(port.value) + sum(port.max_step);
      for (const ExtentSpec& extent : port.extent)
        if (extent.constant.is_valid()) all += sum(spec.constants[extent.constant.index].name);
    }
#ifdef CHIMERA_PLANTED_DEFECT
    volatile char marks[17] = {};  // beyond the end for a user priority of more than 16
    marks[task.user_priority < 17 ? task.user_priority : 17] = 1;
#endif
  }
  for (const GivenSpec& given : spec.operators) {
    require(spec.variables[given.variable.index].name == given.name, "an operator value has the name of its variable");
    all += sum(given.value);
  }
  for (const auto ids : {spec.init_order, spec.start, spec.on_order, spec.end_order})
    for (const TaskId id : ids) require(id.index < spec.tasks.size(), "every task in an order is there");
  for (const StandbySpec& each : spec.standbys)
    require(each.primary.index < spec.tasks.size() && each.standby.index < spec.tasks.size(), "both tasks are there");
  for (const RestartSpec& each : spec.restarts)
    require(each.task.index < spec.tasks.size() && each.most >= 1 && each.within.count > 0, "a restart is in order");
  for (const StaleSpec& each : spec.stale)
    require(each.task.index < spec.tasks.size() && each.after.count > 0, "a limit of age is in order");
  for (const NamedSet& set : spec.sets) {
    for (const TaskId id : set.order) require(id.index < spec.tasks.size(), "every task in a set is there");
    all += sum(set.name);
  }
  return all + check_links(spec);
}

void check(std::span<const std::byte> bytes) {
  const auto image = ApplicationImage::decode(bytes);
  if (!image) return require(!image.error().message.empty(), "a refusal has a reason");
  volatile unsigned all = check_spec(image->spec());
  for (const ComponentPlace& place : image->places()) all = all + sum(place.object_file);
  const std::vector<std::byte> again = encode(image->spec(), image->places(), image->settings());
  require(again.size() == bytes.size() && std::memcmp(again.data(), bytes.data(), again.size()) == 0,
          "what is accepted is written back as it was");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  check(std::as_bytes(std::span(bytes, size)));
  check(with_header(bytes, size));
  return 0;
}
