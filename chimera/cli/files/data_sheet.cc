// SPDX-License-Identifier: Apache-2.0
// Writes the ports of a component as a table, and the sections of its README.md without their markup.
#include "chimera/cli/files/data_sheet.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <vector>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/task/signal.h"
#include "chimera/text/value_text.h"

namespace chimera::cli {
namespace {

constexpr std::size_t kMostSheetBytes = 1 << 20;

std::string type_text(const PortDescriptor& port) {
  const std::string base = port.type_name.empty() ? std::string(type_name(port.type)) : port.type_name;
  return base + port.shape;
}

std::string number_text(double value) { return formatted("%g", value); }

std::string initial_text(const PortDescriptor& port) {
  const std::size_t count = port.initial.size() / port.element_size;
  const ValueForm form{port.type, port.element_size, static_cast<std::uint32_t>(count), count == 1, "1", port.fields};
  return (port.kind == CHIMERA_OUT_VAR ? "initially " : "default ") + value_text(form, port.initial);
}

std::string remarks(const PortDescriptor& port) {
  std::string text;
  const auto add = [&text](const std::string& part) { append_joined(text, "; ", part); };
  if (!port.doc.empty()) add(plain_line(port.doc.substr(0, port.doc.find_last_not_of('.') + 1)));
  if (!port.frame.empty()) add("frame " + port.frame);
  if (port.has_range) add("from " + number_text(port.min) + " to " + number_text(port.max));
  if (!port.at_least.empty()) add("at least " + port.at_least);
  if (!port.one_of.empty()) add("one of " + join(port.one_of, " "));
  if (port.names_configuration) add("names a configuration");
  if (port.shared) add("shared");
  if (port.intermittent) add("a configuration may lack a producer");
  if (port.safe_state) add(port.kind == CHIMERA_RESOURCE ? "never moves" : "safe state");
  if (port.safety) add("safety");
  if (port.repeated) add("repeated, at most " + std::to_string(port.max_instances));
  if (!port.initial.empty()) add(initial_text(port));
  return text;
}

std::string ports_text(const Descriptor& d) {
  std::string text;
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
  return text;
}

std::string head_text(const Descriptor& d) {
  std::string text = d.name + ": " + plain_line(d.doc) + "\n";
  if (!d.source.empty()) text += "source   " + plain_line(d.source) + "\n";
  text += "rate     " +
          (d.default_rate_hz > 0 ? number_text(d.default_rate_hz) + " Hz by default" : "stated by the description") +
          "\n";
  text += "released " + std::string(d.is_aperiodic() ? "by events (sync is asked at its rate)" : "by the timer") + "\n";
  text += "methods ";
  for (std::size_t m = 0; m < CHIMERA_METHODS; ++m)
    if (d.methods[m]) text += std::string(" ") + method_name(static_cast<Method>(m));
  return text + (d.background ? ", and background beside them" : "") + "\n";
}

// "see [car](../car)" becomes "see car", "![Step response](a.svg)" becomes "(picture: Step response)".
std::string without_links(std::string_view line) {
  std::string text;
  for (std::size_t at = 0; at < line.size();) {
    const bool is_picture = line.substr(at).starts_with("![");
    const std::size_t open = at + (is_picture ? 1 : 0);
    const std::size_t close = line[open] == '[' ? line.find_first_of("[]", open + 1) : std::string_view::npos;
    const bool is_link = close != std::string_view::npos && line.substr(close).starts_with("](");
    const std::size_t end = is_link ? line.find(')', close) : std::string_view::npos;
    if (end == std::string_view::npos) {
      text += line[at++];
      continue;
    }
    const std::string words(line.substr(open + 1, close - open - 1));
    text += is_picture ? "(picture: " + words + ")" : words;
    at = end + 1;
  }
  return text;
}

}  // namespace

std::string plain_sheet(std::string_view markdown) {
  std::string text;
  bool is_shown = true, is_first = true;
  while (!markdown.empty()) {
    const std::string_view line = markdown.substr(0, markdown.find('\n'));
    markdown.remove_prefix(std::min(markdown.size(), line.size() + 1));
    const bool is_code = line.starts_with("    ");
    if (is_first || line.starts_with("## ")) is_shown = !is_first && line != "## Ports";
    if (is_first) is_first = false, is_shown = true;
    else if (is_shown && line.starts_with("## ")) text += std::string(line.substr(3)) + "\n";
    else if (is_shown && !line.starts_with("```")) text += (is_code ? std::string(line) : without_links(line)) + "\n";
  }
  std::string tight;  // no empty line twice, none at the ends
  for (const char c : text)
    if (c != '\n' || (!tight.empty() && !tight.ends_with("\n\n"))) tight += c;
  while (tight.ends_with("\n\n")) tight.pop_back();
  return tight;
}

std::string data_sheet(const LibraryEntry& entry) {
  std::string text = head_text(entry.descriptor) + "ports\n" + ports_text(entry.descriptor);
  const auto file = std::filesystem::path(entry.descriptor_file).parent_path() / (entry.descriptor.name + ".md");
  if (const auto sheet = read_ordinary(file.string(), kMostSheetBytes)) text += "\n" + plain_sheet(*sheet) + "\n";
  return text + "file     " + entry.object_file + "\n";
}

}  // namespace chimera::cli
