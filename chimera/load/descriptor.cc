// SPDX-License-Identifier: Apache-2.0
// Compares two descriptors of one component and names the difference.
#include "chimera/load/descriptor.h"

#include <algorithm>
#include <cstdio>

#include "chimera/base/hosted/wording.h"
#include "chimera/task/signal.h"

namespace chimera {
namespace {

constexpr std::string_view kKinds[] = {"in-var",   "out-var",   "in-const",  "out-const",
                                       "resource", "in-stream", "out-stream"};
constexpr std::string_view kTypes[] = {"bool", "int32", "int64", "float32", "float64", "string", "struct", "any"};

std::string number(double value) { return formatted("%.17g", value); }

std::string hex(const std::vector<std::byte>& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::byte b : bytes) {
    text += kDigits[std::to_integer<unsigned>(b) >> 4];
    text += kDigits[std::to_integer<unsigned>(b) & 15u];
  }
  return text;
}

/// All limits of the values, as text. A port without the newer limits gives the same text as before, so that older
/// fingerprints stay equal.
std::string range_text(const PortDescriptor& port) {
  std::string range = port.has_range ? "[" + number(port.min) + ", " + number(port.max) + "]" : "none";
  if (!port.at_least.empty()) range += ", at least " + port.at_least;
  for (const std::string& word : port.one_of) range += (&word == &port.one_of.front() ? ", one of " : " ") + word;
  if (port.names_configuration) range += ", a configuration";
  if (port.safe_state) range += ", the safe state";
  if (port.shared) range += ", shared";
  if (port.intermittent) range += ", intermittent";
  return range;
}

/// One property of a descriptor, as text. Properties are compared in this order.
struct Saying {
  std::string_view what;
  std::string says;
};

std::string field_text(const FieldDescriptor& field) {
  return field.name + " " + std::string(type_name(field.type)) + "[" + std::to_string(field.count) + "] at " +
         std::to_string(field.offset) + ", " + std::to_string(field.size) + " bytes, unit " + field.unit;
}

std::vector<Saying> sayings(const PortDescriptor& port) {
  std::vector<Saying> all{{"kind", std::string(kind_name(port.kind))},
                          {"type", std::string(type_name(port.type))},
                          {"type name", in_double_quotes(port.type_name)},
                          {"element size", std::to_string(port.element_size)},
                          {"unit", in_double_quotes(port.unit)},
                          {"shape", in_double_quotes(port.shape)},
                          {"frame", in_double_quotes(port.frame)},
                          {"safety", port.safety ? "yes" : "no"},
                          {"repeated", port.repeated ? "yes" : "no"},
                          {"maximum of instances", std::to_string(port.max_instances)},
                          {"range", range_text(port)},
                          {"number of fields", std::to_string(port.fields.size())}};
  for (const FieldDescriptor& field : port.fields) all.push_back({"field", field_text(field)});
  all.push_back({"initial value", port.initial.empty() ? "none" : "bytes " + hex(port.initial)});
  return all;
}

std::string methods_text(const Descriptor& descriptor) {
  std::string text;
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m) {
    if (descriptor.methods[m]) append_joined(text, " ", method_name(static_cast<Method>(m)));
  }
  return text;
}

std::vector<Saying> sayings(const Descriptor& descriptor) {
  return {{"name", in_double_quotes(descriptor.name)},
          {"ABI version", std::to_string(descriptor.abi_version)},
          {"default rate", number(descriptor.default_rate_hz) + " Hz"},
          {"methods", methods_text(descriptor)}};
}

Result<void> differ(const std::string& place, std::string_view what, const std::string& file,
                    const std::string& object) {
  const std::string text =
      place + ": " + std::string(what) + ": the descriptor says " + file + ", the object says " + object;
  return Error{ErrorCode::kRefused, std::string_view(text), {}};
}

Result<void> compare(const std::string& place, const std::vector<Saying>& file, const std::vector<Saying>& object) {
  for (std::size_t i = 0; i < std::min(file.size(), object.size()); ++i) {
    if (file[i].says != object[i].says) return differ(place, file[i].what, file[i].says, object[i].says);
  }
  return {};
}

}  // namespace

std::string_view kind_name(std::uint32_t kind) noexcept {
  CHIMERA_ASSERT(kind < std::size(kKinds));
  return kKinds[kind];
}

std::string_view type_name(std::uint32_t type) noexcept {
  CHIMERA_ASSERT(type < std::size(kTypes));
  return kTypes[type];
}

std::uint32_t type_size(std::uint32_t type) noexcept {
  constexpr std::uint32_t kSizes[] = {1, 4, 8, 4, 8, 0, 0, 8};
  CHIMERA_ASSERT(type < std::size(kSizes));
  return kSizes[type];
}

bool is_identifier(std::string_view text) noexcept {
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_rest = [&](char c) { return is_lower(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !text.empty() && text.size() <= 64 && is_lower(text.front()) &&
         std::all_of(text.begin(), text.end(), is_rest);
}

std::uint32_t PortDescriptor::initial_count() const noexcept {
  return element_size == 0 ? 0 : static_cast<std::uint32_t>(initial.size() / element_size);
}

const PortDescriptor* Descriptor::port(std::string_view port_name) const noexcept {
  const auto found =
      std::find_if(ports.begin(), ports.end(), [&](const PortDescriptor& p) { return p.name == port_name; });
  return found == ports.end() ? nullptr : &*found;
}

Result<void> match(const Descriptor& file, const Descriptor& object) {
  const std::string place = "component " + file.name;
  if (const auto same = compare(place, sayings(file), sayings(object)); !same) return same;
  for (std::size_t i = 0; i < file.ports.size(); ++i) {
    const std::string port_place = place + ": port " + file.ports[i].name;
    if (i >= object.ports.size()) return differ(port_place, "port", "it exists", "nothing");
    if (file.ports[i].name != object.ports[i].name) {
      return differ(place + ": port " + std::to_string(i + 1), "name", in_double_quotes(file.ports[i].name),
                    in_double_quotes(object.ports[i].name));
    }
    if (const auto same = compare(port_place, sayings(file.ports[i]), sayings(object.ports[i])); !same) return same;
  }
  if (file.ports.size() < object.ports.size()) {
    return differ(place + ": port " + object.ports[file.ports.size()].name, "port", "nothing", "it exists");
  }
  return {};
}

std::uint64_t fingerprint(const Descriptor& descriptor) {
  // FNV-1a over the texts that match() compares, so that fingerprint and match() always agree.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash](std::string_view text) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    hash = (hash ^ 0x1fu) * 0x100000001b3u;  // an end mark: "ab","c" is not "a","bc"
  };
  for (const Saying& saying : sayings(descriptor)) add(saying.says);
  for (const PortDescriptor& port : descriptor.ports) {
    add(port.name);
    for (const Saying& saying : sayings(port)) add(saying.says);
  }
  return hash;
}

}  // namespace chimera
