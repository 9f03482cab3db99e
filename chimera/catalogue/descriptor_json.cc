// SPDX-License-Identifier: Apache-2.0
// Writes descriptors as JSON and reads them. Refuses every file that no component could have declared.
#include "chimera/catalogue/descriptor_json.h"

#include <cmath>
#include <cstdio>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/descriptor_value.h"
#include "chimera/task/signal.h"
#include "chimera/text/json.h"
#include "chimera/text/json_cursor.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

std::vector<std::string> words(std::uint32_t count, std::string_view (*name)(std::uint32_t)) {
  std::vector<std::string> all;
  for (std::uint32_t i = 0; i < count; ++i) all.emplace_back(name(i));
  return all;
}

std::string_view name_of_method(std::uint32_t i) { return method_name(static_cast<Method>(i)); }
std::string_view name_of_kind(std::uint32_t i) { return kind_name(i); }
std::string_view name_of_type(std::uint32_t i) { return type_name(i); }

/// The index in `all` of the word at the cursor.
std::uint32_t word_at(const JsonCursor& at, std::string_view what, const std::vector<std::string>& all) {
  const std::string word = at.text();
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    if (all[i] == word) return i;
  }
  at.refuse("no " + std::string(what) + " is called " + in_double_quotes(word.substr(0, 60)) +
            did_you_mean(nearest(word, all), '"'));
}

std::string optional_text(const JsonCursor& at, std::string_view key) { return at.has(key) ? at.at(key).text() : ""; }

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

// Reading.

void read_plain(const JsonCursor& at, std::uint32_t type, std::span<std::byte> to) {
  PlainValue value;
  const Json& json = at.value();
  if (json.is_bool()) {
    value = json.as_bool();
  } else if (json.is_whole() && json.as_uint64() <= INT64_MAX) {
    value = json.as_int64();
  } else if (type == CHIMERA_STRING) {
    value = at.text();
  } else {
    value = at.number();
  }
  if (!store_plain(type, value, to)) at.refuse("the value does not fit a " + std::string(type_name(type)));
}

void read_struct(const JsonCursor& at, const PortDescriptor& port, std::span<std::byte> element) {
  if (!at.value().is_object() || at.value().size() != port.fields.size()) {
    at.refuse("expected an object with the " + std::to_string(port.fields.size()) + " fields of " + port.type_name);
  }
  for (const FieldDescriptor& field : port.fields) {
    if (!at.has(field.name)) at.refuse("the field \"" + field.name + "\" is missing");
    const JsonCursor list = at.at(field.name);
    if (list.size(field.count) != field.count) list.refuse("expected " + std::to_string(field.count) + " values");
    for (std::uint32_t i = 0; i < field.count; ++i) {
      read_plain(list.at(i), field.type, element.subspan(field.offset + std::size_t{i} * field.size, field.size));
    }
  }
}

std::vector<std::byte> read_initial(const JsonCursor& at, const PortDescriptor& port) {
  const std::size_t count = at.size(kMaxExtent);
  std::vector<std::byte> bytes(count * port.element_size);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<std::byte> element = std::span(bytes).subspan(i * port.element_size, port.element_size);
    if (port.type == CHIMERA_STRUCT)
      read_struct(at.at(i), port, element);
    else
      read_plain(at.at(i), port.type, element);
  }
  return bytes;
}

FieldDescriptor read_field(const JsonCursor& at) {
  at.expect_keys({"name", "unit", "type", "offset", "count", "size"}, {});
  return {at.at("name").text(),
          at.at("unit").text(),
          word_at(at.at("type"), "type", words(CHIMERA_STRING + 1, name_of_type)),
          at.at("offset").whole(),
          at.at("count").whole(),
          at.at("size").whole()};
}

PortDescriptor read_port_frame(const JsonCursor& at) {
  at.expect_keys(
      {"name", "kind", "type", "element_size", "unit", "shape"},
      {"doc", "type_name", "frame", "safety", "max_instances", "range", "at_least", "one_of", "configuration",
       "safe_state", "shared", "intermittent", "fields", "initial"});
  PortDescriptor port;
  port.name = at.at("name").text();
  port.kind = word_at(at.at("kind"), "kind", words(CHIMERA_OUT_STREAM + 1, name_of_kind));
  port.type = word_at(at.at("type"), "type", words(CHIMERA_ANY + 1, name_of_type));
  port.element_size = at.at("element_size").whole();
  port.unit = at.at("unit").text();
  port.shape = at.at("shape").text();
  port.doc = optional_text(at, "doc");
  port.type_name = optional_text(at, "type_name");
  port.frame = optional_text(at, "frame");
  port.at_least = optional_text(at, "at_least");
  if (at.has("one_of")) {
    const JsonCursor words = at.at("one_of");
    for (std::size_t i = 0; i < words.size(64); ++i) port.one_of.push_back(words.at(i).text());
  }
  port.names_configuration = at.has("configuration") && at.at("configuration").truth();
  port.safe_state = at.has("safe_state") && at.at("safe_state").truth();
  port.shared = at.has("shared") && at.at("shared").truth();
  port.intermittent = at.has("intermittent") && at.at("intermittent").truth();
  port.safety = at.has("safety") && at.at("safety").truth();
  port.repeated = at.has("max_instances");
  if (port.repeated) port.max_instances = at.at("max_instances").whole();
  return port;
}

/// complete() must check the sizes of a port first, because they give the layout of its initial values.
void prove_sizes(const JsonCursor& at, const PortDescriptor& port) {
  Descriptor alone{.name = "c", .doc = {}, .source = {}, .default_rate_hz = 0, .methods = {}, .ports = {port}};
  alone.methods[CHIMERA_CYCLE] = true;
  alone.ports[0].initial.clear();
  alone.ports[0].at_least.clear();
  if (const auto sound = complete(alone); !sound) {
    at.refuse(sound.error().message.view().substr(std::string_view("component c: ").size()));
  }
}

PortDescriptor read_port(const JsonCursor& at) {
  PortDescriptor port = read_port_frame(at);
  if (at.has("range")) {
    const JsonCursor range = at.at("range");
    if (range.size(2) != 2) range.refuse("expected two numbers");
    port.has_range = true;
    port.min = range.at(0).number();
    port.max = range.at(1).number();
  }
  if (at.has("fields")) {
    const JsonCursor fields = at.at("fields");
    for (std::size_t i = 0; i < fields.size(64); ++i) port.fields.push_back(read_field(fields.at(i)));
  }
  if (at.has("initial")) {
    prove_sizes(at, port);
    port.initial = read_initial(at.at("initial"), port);
    if (port.initial.empty()) at.at("initial").refuse("an empty list");
  }
  return port;
}

Descriptor read_component(const JsonCursor& at) {
  at.expect_keys({"format", "name", "abi_version", "default_rate_hz", "state_size", "state_align", "methods", "ports"},
                 {"doc", "source", "background", "event_source", "fingerprint"});
  if (at.at("format").whole() != 1) at.at("format").refuse("this reader knows format 1");
  Descriptor descriptor;
  descriptor.name = at.at("name").text();
  descriptor.doc = optional_text(at, "doc");
  descriptor.source = optional_text(at, "source");
  descriptor.abi_version = at.at("abi_version").whole();
  if (descriptor.abi_version != CHIMERA_ABI_VERSION) {
    at.at("abi_version")
        .refuse(descriptor.name + " was built for ABI " + std::to_string(descriptor.abi_version) +
                ", and this chimera needs ABI " + std::to_string(CHIMERA_ABI_VERSION));
  }
  descriptor.default_rate_hz = at.at("default_rate_hz").number();
  descriptor.state_size = at.at("state_size").whole();
  descriptor.state_align = at.at("state_align").whole();
  const JsonCursor methods = at.at("methods");
  for (std::size_t i = 0; i < methods.size(CHIMERA_METHODS); ++i) {
    descriptor.methods[word_at(methods.at(i), "method", words(CHIMERA_METHODS, name_of_method))] = true;
  }
  if (at.has("background")) descriptor.background = at.at("background").truth();
  if (at.has("event_source")) descriptor.event_source = at.at("event_source").truth();
  const JsonCursor ports = at.at("ports");
  for (std::size_t i = 0; i < ports.size(CHIMERA_MAX_PORTS); ++i) descriptor.ports.push_back(read_port(ports.at(i)));
  if (const auto sound = complete(descriptor); !sound) at.refuse(sound.error().message.view());
  if (at.has("fingerprint") && at.at("fingerprint").text() != hex(fingerprint(descriptor))) {
    at.at("fingerprint").refuse("the file was changed: its content gives " + hex(fingerprint(descriptor)));
  }
  return descriptor;
}

// Writing.

Json number_json(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json plain_json(std::uint32_t type, std::span<const std::byte> at) {
  const PlainValue value = load_plain(type, at);
  if (const auto* real = std::get_if<double>(&value)) return number_json(*real);
  return std::visit([](const auto& v) { return Json(v); }, value);
}

Json element_json(const PortDescriptor& port, std::span<const std::byte> element) {
  if (port.type != CHIMERA_STRUCT) return plain_json(port.type, element);
  Json object = Json::object();
  for (const FieldDescriptor& field : port.fields) {
    Json list = Json::array();
    for (std::uint32_t i = 0; i < field.count; ++i) {
      list.push_back(plain_json(field.type, element.subspan(field.offset + std::size_t{i} * field.size, field.size)));
    }
    object[field.name] = std::move(list);
  }
  return object;
}

Json port_json(const PortDescriptor& port) {
  Json json{{"name", port.name}, {"kind", kind_name(port.kind)}, {"type", type_name(port.type)}};
  if (!port.type_name.empty()) json["type_name"] = port.type_name;
  json["element_size"] = port.element_size;
  json["unit"] = port.unit;
  json["shape"] = port.shape;
  if (!port.frame.empty()) json["frame"] = port.frame;
  if (port.safety) json["safety"] = true;
  if (port.repeated) json["max_instances"] = port.max_instances;
  if (port.has_range) json["range"] = {number_json(port.min), number_json(port.max)};
  if (!port.at_least.empty()) json["at_least"] = port.at_least;
  if (!port.one_of.empty()) json["one_of"] = port.one_of;
  if (port.names_configuration) json["configuration"] = true;
  if (port.safe_state) json["safe_state"] = true;
  if (port.shared) json["shared"] = true;
  if (port.intermittent) json["intermittent"] = true;
  for (const FieldDescriptor& field : port.fields) {
    json["fields"].push_back(Json{{"name", field.name},
                                  {"unit", field.unit},
                                  {"type", type_name(field.type)},
                                  {"offset", field.offset},
                                  {"count", field.count},
                                  {"size", field.size}});
  }
  const std::span<const std::byte> initial(port.initial);
  for (std::size_t at = 0; at < initial.size(); at += port.element_size) {
    json["initial"].push_back(element_json(port, initial.subspan(at, port.element_size)));
  }
  if (!port.doc.empty()) json["doc"] = port.doc;
  return json;
}

}  // namespace

Result<Descriptor> parse_descriptor(std::string_view text) {
  try {
    const Json tree = read_json(text, kMaxDescriptorBytes, kMaxDescriptorNesting);
    return read_component(JsonCursor(tree, "$"));
  } catch (const JsonRefusal& refusal) {
    return Error{ErrorCode::kBadInput, std::string_view(refusal.message), {}};
  } catch (const JsonError& error) {
    return Error{ErrorCode::kBadInput, std::string_view(error.what()), {}};
  }
}

std::string to_json(const Descriptor& descriptor) {
  Json json{{"format", 1}, {"name", descriptor.name}};
  if (!descriptor.doc.empty()) json["doc"] = descriptor.doc;
  if (!descriptor.source.empty()) json["source"] = descriptor.source;
  json["abi_version"] = descriptor.abi_version;
  json["default_rate_hz"] = descriptor.default_rate_hz;
  json["state_size"] = descriptor.state_size;
  json["state_align"] = descriptor.state_align;
  json["methods"] = Json::array();
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m) {
    if (descriptor.methods[m]) json["methods"].push_back(name_of_method(m));
  }
  if (descriptor.background) json["background"] = true;
  if (descriptor.event_source) json["event_source"] = true;
  json["ports"] = Json::array();
  for (const PortDescriptor& port : descriptor.ports) json["ports"].push_back(port_json(port));
  json["fingerprint"] = hex(fingerprint(descriptor));
  return json.dump(Json::Style::kLines) + "\n";
}

Result<Descriptor> read_descriptor_file(const std::string& path) {
  const auto text = read_ordinary(path, kMaxDescriptorBytes + 1);
  if (!text) return text.error();
  auto parsed = parse_descriptor(*text);
  if (parsed) return parsed;
  Error error = parsed.error();
  error.where = FixedString<200>(std::string_view(path));
  return error;
}

}  // namespace chimera
