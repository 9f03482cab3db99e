// SPDX-License-Identifier: Apache-2.0
// Copies a declaration with pointers into owned data. The rules are in declaration_rules.cc.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "chimera/load/descriptor.h"
#include "chimera/task/background.h"
#include "chimera/task/choices.h"
#include "chimera/task/event_source.h"
#include "chimera/task/orders.h"

namespace chimera {
namespace {

Error refused(const std::string& place, const std::string& why) {
  const std::string text = place + ": " + why;
  return {ErrorCode::kBadInput, std::string_view(text), {}};
}

std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// Copies `count` values of a plain type. Strings end at their zero, so bytes behind it cannot make copies differ.
void copy_plain(std::byte* to, const std::byte* from, std::uint32_t type, std::uint32_t size, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i, to += size, from += size) {
    const std::size_t used =
        type == CHIMERA_STRING ? ::strnlen(reinterpret_cast<const char*>(from), size) : std::size_t{size};
    std::memcpy(to, from, used);
  }
}

std::vector<std::byte> initial_of(const chimera_port_decl& port, const PortDescriptor& descriptor) {
  std::vector<std::byte> bytes(std::size_t{port.initial_count} * port.element_size);
  const auto* from = static_cast<const std::byte*>(port.initial);
  if (descriptor.type != CHIMERA_STRUCT) {
    copy_plain(bytes.data(), from, port.type, port.element_size, port.initial_count);
    return bytes;
  }
  for (std::size_t at = 0; at < bytes.size(); at += port.element_size) {
    for (const FieldDescriptor& field : descriptor.fields) {
      if (std::uint64_t{field.offset} + std::uint64_t{field.size} * field.count > port.element_size) continue;
      copy_plain(bytes.data() + at + field.offset, from + at + field.offset, field.type, field.size, field.count);
    }
  }
  return bytes;
}

Result<void> check_pointers(const std::string& place, const chimera_port_decl& port,
                            const chimera_component& component) {
  if (port.n_fields > 0 && port.fields == nullptr) return refused(place, "has fields but no list of them");
  if (port.n_fields > 64) return refused(place, std::to_string(port.n_fields) + " fields, at most 64 are allowed");
  const std::uint64_t live_end = port.live_offset + std::uint64_t{sizeof(chimera_port)} * port.max_instances;
  if (port.max_instances > CHIMERA_MAX_INSTANCES || live_end > component.state_size ||
      port.live_offset % alignof(chimera_port) != 0) {
    return refused(place, "its chimera_port at offset " + std::to_string(port.live_offset) + " with " +
                              std::to_string(port.max_instances) + " instances does not lie in the state of " +
                              std::to_string(component.state_size) + " bytes");
  }
  const bool repeated = (port.flags & CHIMERA_PORT_REPEATED) != 0;
  if (repeated && (std::uint64_t{port.instances_offset} + 4 > component.state_size || port.instances_offset % 4 != 0)) {
    return refused(place, "its number of instances does not lie in the state");
  }
  if (port.flags >= CHIMERA_PORT_INTERMITTENT << 1) return refused(place, "unknown flags");
  if ((port.flags & CHIMERA_PORT_HAS_INITIAL) == 0) return {};
  if (port.initial == nullptr || port.initial_count == 0) {
    return refused(place, "says it has an initial value but gives none");
  }
  if (port.initial_count > kMaxExtent || port.element_size > kMaxExtent) {
    return refused(place, "the initial value is too large");
  }
  return {};
}

PortDescriptor copy_port(const chimera_port_decl& port) {
  PortDescriptor copy{.name = text_of(port.name),
                      .doc = text_of(port.doc),
                      .unit = text_of(port.unit),
                      .shape = text_of(port.shape),
                      .frame = text_of(port.frame),
                      .type_name = text_of(port.type_name),
                      .kind = port.kind,
                      .type = port.type,
                      .element_size = port.element_size,
                      .safety = (port.flags & CHIMERA_PORT_SAFETY) != 0,
                      .repeated = (port.flags & CHIMERA_PORT_REPEATED) != 0,
                      .max_instances = port.max_instances,
                      .has_range = (port.flags & CHIMERA_PORT_HAS_RANGE) != 0,
                      .min = 0,
                      .max = 0,
                      .at_least = {},
                      .one_of = {},
                      .names_configuration = (port.flags & CHIMERA_PORT_CONFIGURATION) != 0,
                      .safe_state = (port.flags & CHIMERA_PORT_SAFE_STATE) != 0,
                      .shared = (port.flags & CHIMERA_PORT_SHARED) != 0,
                      .intermittent = (port.flags & CHIMERA_PORT_INTERMITTENT) != 0,
                      .extents = {},
                      .fields = {},
                      .initial = {}};
  if (copy.has_range) {
    copy.min = port.min;
    copy.max = port.max;
  }
  for (std::uint32_t i = 0; i < port.n_fields; ++i) {
    const chimera_field& field = port.fields[i];
    copy.fields.push_back(
        {text_of(field.name), text_of(field.unit), field.type, field.offset, field.count, field.size});
  }
  if (port.kind == CHIMERA_RESOURCE && copy.unit.empty()) copy.unit = "1";
  if ((port.flags & CHIMERA_PORT_HAS_INITIAL) != 0) copy.initial = initial_of(port, copy);
  return copy;
}

Result<void> check_component(const std::string& place, const chimera_component& component) {
  if (component.construct == nullptr || component.destroy == nullptr) {
    return refused(place, "has no construct or destroy");
  }
  if (component.state_align == 0 || (component.state_align & (component.state_align - 1)) != 0 ||
      component.state_align > 4096) {
    return refused(place, "state alignment " + std::to_string(component.state_align) +
                              " is no power of two from 1 to 4096");
  }
  if (component.n_ports > CHIMERA_MAX_PORTS) {
    return refused(place, std::to_string(component.n_ports) + " ports, at most 64 are allowed");
  }
  if (orders_of(component).size() > CHIMERA_MAX_PORTS) return refused(place, "has more orders than ports");
  if (choices_of(component).size() > CHIMERA_MAX_PORTS) return refused(place, "has more choices than ports");
  if (component.n_ports > 0 && component.ports == nullptr) return refused(place, "has ports but no list of them");
  return {};
}

Result<void> copy_orders(const std::string& place, const chimera_component& component, Descriptor& to) {
  for (const chimera_order& order : orders_of(component)) {
    const std::string lower = text_of(order.lower), upper = text_of(order.upper);
    const auto port = std::find_if(to.ports.begin(), to.ports.end(), [&](const auto& p) { return p.name == upper; });
    if (port == to.ports.end()) return refused(place, "no port \"" + upper + "\" is there to be at least " + lower);
    if (!port->at_least.empty())
      return refused(place + ": port " + upper, "is declared to be at least two other ports; one is allowed");
    port->at_least = lower;
  }
  return {};
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    words.emplace_back(text.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

Result<void> copy_choices(const std::string& place, const chimera_component& component, Descriptor& to) {
  for (const chimera_choice& choice : choices_of(component)) {
    const std::string name = text_of(choice.port);
    const auto port = std::find_if(to.ports.begin(), to.ports.end(), [&](const auto& p) { return p.name == name; });
    if (port == to.ports.end()) return refused(place, "no port \"" + name + "\" is there to be one of some words");
    if (!port->one_of.empty())
      return refused(place + ": port " + name, "has two lists of words it may be; one is allowed");
    port->one_of = words_of(text_of(choice.words));
  }
  return {};
}

Result<void> check_version(const chimera_component& component) {
  if (component.abi_version != CHIMERA_ABI_VERSION) {
    return refused("component", "it was built for ABI " + std::to_string(component.abi_version) +
                                    ", and this chimera needs ABI " + std::to_string(CHIMERA_ABI_VERSION) +
                                    ": rebuild it");
  }
  // A smaller struct_size is legal: an older object was built before the last members existed.
  if (component.struct_size != sizeof(chimera_component) &&
      component.struct_size != offsetof(chimera_component, host_size) &&
      component.struct_size != offsetof(chimera_component, n_choices) &&
      component.struct_size != offsetof(chimera_component, n_orders) &&
      component.struct_size != offsetof(chimera_component, event_source) &&
      component.struct_size != offsetof(chimera_component, background)) {
    return refused("component", "declaration of " + std::to_string(component.struct_size) + " bytes, expected " +
                                    std::to_string(sizeof(chimera_component)));
  }
  const bool knows_host = component.struct_size == sizeof(chimera_component);
  if (knows_host && component.host_size > sizeof(chimera_host))
    return refused("component", "it was built with a newer chimera than this one: rebuild it, or install that chimera");
  return {};
}

}  // namespace

Result<Descriptor> describe(const chimera_component& component) {
  if (const auto known = check_version(component); !known) return known.error();
  Descriptor descriptor{.name = text_of(component.name),
                        .doc = text_of(component.doc),
                        .source = text_of(component.source),
                        .abi_version = component.abi_version,
                        .default_rate_hz = component.default_rate_hz,
                        .state_size = component.state_size,
                        .state_align = component.state_align,
                        .methods = {},
                        .ports = {}};
  const std::string place = "component " + descriptor.name;
  if (const auto sound = check_component(place, component); !sound) return sound.error();
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m) descriptor.methods[m] = component.methods[m] != nullptr;
  descriptor.background = background_of(component) != nullptr;
  descriptor.event_source = event_source_of(component) != nullptr;
  for (std::uint32_t i = 0; i < component.n_ports; ++i) {
    const chimera_port_decl& port = component.ports[i];
    const auto sound = check_pointers(place + ": port " + text_of(port.name), port, component);
    if (!sound) return sound.error();
    descriptor.ports.push_back(copy_port(port));
  }
  if (const auto copied = copy_orders(place, component, descriptor); !copied) return copied.error();
  if (const auto copied = copy_choices(place, component, descriptor); !copied) return copied.error();
  if (const auto done = complete(descriptor); !done) return done.error();
  return descriptor;
}

}  // namespace chimera
