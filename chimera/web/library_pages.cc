// SPDX-License-Identifier: Apache-2.0
// Puts together what the library, its sheets and the lessons say of a component.
#include "chimera/web/library_pages.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/text/nearest.h"
#include "chimera/web/fitting_ports.h"

namespace chimera::web {

using control::RpcResponse;

namespace {

constexpr std::size_t kMostSheetBytes = std::size_t{1} << 20, kMostFitting = 24, kMostValues = 20;

/// The file NAME`ending` beside the descriptor.
Result<std::string> read_beside(const LibraryEntry& entry, const char* ending, std::size_t most) {
  const std::string folder = entry.descriptor_file.substr(0, entry.descriptor_file.rfind('/') + 1);
  return read_ordinary(folder + entry.descriptor.name + ending, most);
}

Json text_or_null(std::string text) { return text.empty() ? Json() : Json(std::move(text)); }

Json ports_json(const Descriptor& descriptor) {
  Json ports = Json::array();
  for (const PortDescriptor& port : descriptor.ports)
    ports.push_back({{"port", port.name},
                     {"kind", kind_name(port.kind)},
                     {"type", port.type_name.empty() ? std::string(type_name(port.type)) : port.type_name},
                     {"unit", port.unit},
                     {"shape", port.shape},
                     {"repeated", port.repeated},
                     {"doc", port.doc}});
  return ports;
}

Json component_json(const LibraryEntry& entry) {
  const Descriptor& d = entry.descriptor;
  const auto read = read_beside(entry, ".md", kMostSheetBytes);
  const std::string sheet = read ? *read : "";
  Json component{{"name", d.name}, {"doc", d.doc}, {"file", entry.object_file}};
  component["rate_hz"] = d.default_rate_hz > 0 ? Json(d.default_rate_hz) : Json();
  component["aperiodic"] = d.is_aperiodic();
  component["time"] = text_or_null(time_on_sheet(sheet));
  component["papers"] = cited_papers(sheet);
  component["words"] = words_of(sheet);
  component["ports"] = ports_json(d);
  return component;
}

Json fits_json(const Library& library, const Descriptor& descriptor) {
  Json fits = Json::array();
  for (const PortDescriptor& port : descriptor.ports) {
    const FittingPorts found = fitting_ports(library, port, kMostFitting);
    Json with = Json::array();
    for (const FittingPort& other : found.with) with.push_back({{"component", other.component}, {"port", other.port}});
    if (!with.empty()) fits.push_back({{"port", port.name}, {"with", with}, {"more", found.n_more}});
  }
  return fits;
}

RpcResponse no_component(const Library& library, const std::string& name) {
  const std::string near = library.nearest_name(name);
  return RpcResponse::unknown("no component " + in_quotes(name) + did_you_mean(near), "component", near);
}

/// The files of code in the folder of the sheet.
std::vector<std::string> sources_of(const Documents& documents, const std::string& sheet) {
  const std::string folder = sheet.substr(0, sheet.rfind('/') + 1);
  std::vector<std::string> sources;
  for (const std::string& name : documents.names()) {
    const bool is_code = name.ends_with(".cc") || name.ends_with(".c") || name.ends_with(".h");
    if (is_code && !name.ends_with("_test.cc") && name.starts_with(folder) &&
        name.find('/', folder.size()) == std::string::npos)
      sources.push_back(name);
  }
  return sources;
}

}  // namespace

Json LibraryPages::library(const Library& library) const {
  Json components = Json::array(), faults = Json::array(), documents = Json::array();
  for (const LibraryEntry& entry : library.entries()) components.push_back(component_json(entry));
  for (const Error& fault : library.faults())
    faults.push_back({{"file", fault.where.view()}, {"message", fault.message.view()}});
  for (const auto& [name, title] : documents_.titles()) documents.push_back({{"name", name}, {"title", title}});
  Json answer = Json::object();
  answer["components"] = std::move(components);
  answer["faults"] = std::move(faults);
  answer["documents"] = std::move(documents);
  return answer;
}

RpcResponse LibraryPages::sheet(const Library& library, const std::string& component) {
  const LibraryEntry* entry = library.find(component);
  if (entry == nullptr) return no_component(library, component);
  const auto text = read_beside(*entry, ".md", kMostSheetBytes);
  const std::string name = "library/" + component + "/README.md";
  const auto document = documents_.read(name);
  const bool is_document = text && document && *text == *document;
  Json lessons = Json::array();
  std::set<std::string> named;
  for (const Example& example : examples()) {
    const std::string lesson = example.name.substr(0, example.name.rfind('/')) + "/README.md";
    const auto title = documents_.titles().find(lesson);
    if (title != documents_.titles().end() && uses(example, component) && named.insert(lesson).second)
      lessons.push_back({{"document", lesson}, {"title", title->second}});
  }
  Json answer = Json::object();
  answer["component"] = component;
  answer["document"] = is_document ? Json(name) : Json();
  answer["text"] = text ? Json(*text) : Json();
  answer["sources"] = is_document ? sources_of(documents_, name) : std::vector<std::string>();
  answer["lessons"] = std::move(lessons);
  answer["fits"] = fits_json(library, entry->descriptor);
  return RpcResponse::good(answer);
}

RpcResponse LibraryPages::document(const std::string& name) const {
  const auto bytes = documents_.read(name);
  if (!bytes && bytes.error().code == ErrorCode::kNotFound && !documents_.has(name))
    return RpcResponse::no_such("document", name.substr(0, 200), documents_.names());
  if (!bytes) return RpcResponse::refused("document", name + " " + bytes.error().message.c_str(), name);
  const std::string_view type = Documents::picture_type(name);
  if (type.empty()) return RpcResponse::good({{"name", name}, {"text", *bytes}});
  return RpcResponse::good({{"name", name}, {"type", type}, {"base64", base64(*bytes)}});
}

RpcResponse LibraryPages::values(const Library& library, const std::string& component, const std::string& port) {
  const LibraryEntry* entry = library.find(component);
  if (entry == nullptr) return no_component(library, component);
  if (entry->descriptor.port(port) == nullptr) {
    std::vector<std::string> ports;
    for (const PortDescriptor& one : entry->descriptor.ports) ports.push_back(one.name);
    return RpcResponse::no_such("port", port, ports);
  }
  std::vector<OfferedValue> found;
  for (const Example& example : examples()) add_values(example, component, port, kMostValues, found);
  if (const auto test = read_beside(*entry, ".test.yaml", kMaxTextBytes))
    add_values(example_of(component + ".test.yaml", *test), component, port, kMostValues, found);
  Json values = Json::array();
  for (const OfferedValue& one : found) values.push_back({{"value", one.value}, {"origin", one.origin}});
  Json answer = Json::object();
  answer["values"] = std::move(values);
  return RpcResponse::good(answer);
}

const std::vector<Example>& LibraryPages::examples() {
  if (!examples_) examples_ = read_examples(documents_);
  return *examples_;
}

std::vector<std::string> cited_papers(std::string_view sheet) {
  constexpr std::string_view kLink = "papers.md#";
  std::set<std::string> papers;
  for (std::size_t at = sheet.find(kLink); at != std::string_view::npos; at = sheet.find(kLink, at)) {
    at += kLink.size();
    papers.emplace(sheet.substr(at, sheet.find_first_of(") \n", at) - at));
  }
  return {papers.begin(), papers.end()};
}

std::string time_on_sheet(std::string_view sheet) {
  constexpr std::string_view kHeading = "\n## Execution time\n";
  const std::size_t at = sheet.find(kHeading);
  if (at == std::string_view::npos) return "";
  std::string_view text = sheet.substr(at + kHeading.size());
  text = text.substr(std::min(text.size(), text.find_first_not_of('\n')));
  text = text.substr(0, text.find_first_of("`\n"));
  return std::string(text.substr(0, text.find_last_not_of(" (:") + 1));
}

std::string words_of(std::string_view text) {
  std::set<std::string> words;
  std::string word;
  const auto end = [&] {
    const bool is_number = !word.empty() && std::isdigit(static_cast<unsigned char>(word[0])) != 0;
    if (word.size() >= 3 || is_number) words.insert(word);
    word.clear();
  };
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (letter < 0x80 && std::isalnum(letter) == 0 && c != '_')
      end();
    else
      word += static_cast<char>(std::tolower(letter));
  }
  end();
  std::string all;
  for (const std::string& one : words) append_joined(all, " ", one);
  return all;
}

}  // namespace chimera::web
