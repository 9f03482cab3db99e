// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/list.h"

#include <algorithm>
#include <cstdio>

#include "chimera/config/descriptor_json.h"

namespace chimera::desk {
namespace {

constexpr const char* kMethodWords[] = {"init", "reinit", "on", "cycle", "sync", "off", "kill", "error", "clear"};

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

std::string type_text(const PortDescriptor& port) {
  const std::string base = port.type_name.empty() ? std::string(type_name(port.type)) : port.type_name;
  return base + port.shape;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string remarks(const PortDescriptor& port) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (!port.doc.empty()) add(port.doc);
  if (!port.frame.empty()) add("frame " + port.frame);
  if (port.has_range) add("from " + number_text(port.min) + " to " + number_text(port.max));
  if (port.safety) add("safety");
  if (port.repeated) add("repeated, at most " + std::to_string(port.max_instances));
  if (!port.initial.empty()) add(port.kind == CHIMERA_IN_CONST ? "has a default" : "has an initial value");
  return text;
}

std::string sheet(const LibraryEntry& entry) {
  const Descriptor& d = entry.descriptor;
  std::string text = d.name + ": " + d.doc + "\n";
  if (!d.source.empty()) text += "source   " + d.source + "\n";
  text += "rate     " +
          (d.default_rate_hz > 0 ? number_text(d.default_rate_hz) + " Hz by default" : "stated by the description") +
          "\n";
  text += "released " + std::string(d.is_aperiodic() ? "by events (sync is asked at its rate)" : "by the timer") + "\n";
  text += "methods ";
  for (std::size_t m = 0; m < CHIMERA_METHODS; ++m)
    if (d.methods[m]) text += std::string(" ") + kMethodWords[m];
  if (d.background) text += ", and background beside them";
  text += "\nports\n";
  std::size_t name_width = 4, type_width = 4, unit_width = 4;
  for (const PortDescriptor& port : d.ports) {
    name_width = std::max(name_width, port.name.size() + (port.repeated ? 1 : 0));
    type_width = std::max(type_width, type_text(port).size());
    unit_width = std::max(unit_width, port.unit.size());
  }
  for (const PortDescriptor& port : d.ports) {
    std::string line = "  " + padded(std::string(kind_name(port.kind)), 9) + "  " +
                       padded(port.name + (port.repeated ? "*" : ""), name_width) + "  ";
    if (port.kind != CHIMERA_RESOURCE)
      line += padded(type_text(port), type_width) + "  " + padded(port.unit, unit_width) + "  ";
    line += remarks(port);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text + "file     " + entry.object_file + "\n";
}

Error unknown(const std::string& name, const Library& library) {
  const std::string nearest = library.nearest_name(name);
  std::string message = "no component '" + name + "' is installed";
  if (!nearest.empty()) message += "; did you mean '" + nearest + "'?";
  else message += "; `chimera list` names those that are, CHIMERA_PATH says where to look";
  return {ErrorCode::kNotFound, {message}, {}};
}

}  // namespace

Output list(const Workplace& workplace, bool json) {
  const auto library = workplace.library();
  if (!library) return refused(library.error(), json);
  Output output;
  std::size_t width = 4;
  for (const LibraryEntry& entry : library->entries()) width = std::max(width, entry.descriptor.name.size());
  std::string rows;
  for (const LibraryEntry& entry : library->entries()) {
    const Descriptor& d = entry.descriptor;
    output.out += padded(d.name, width) + "  " + d.doc + "\n";
    rows += (rows.empty() ? "" : ", ") + std::string("{\"name\": ") + json_string(d.name) +
            ", \"doc\": " + json_string(d.doc) + ", \"file\": " + json_string(entry.object_file) + "}";
  }
  if (json) output.out = "{\"components\": [" + rows + "]}\n";
  else if (library->entries().empty()) output.err = "no components found; CHIMERA_PATH says where to look\n";
  for (const Error& fault : library->faults()) output.err += error_line(fault);
  if (!library->faults().empty()) output.code = kRefused;
  return output;
}

Output describe_component(const std::string& name, const Workplace& workplace, bool json) {
  const auto library = workplace.library();
  if (!library) return refused(library.error(), json);
  const LibraryEntry* entry = library->find(name);
  if (entry == nullptr) return refused(unknown(name, *library), json);
  Output output;
  output.out = json ? to_json(entry->descriptor) : sheet(*entry);
  return output;
}

}  // namespace chimera::desk
