// SPDX-License-Identifier: Apache-2.0
// Packs a description, its descriptors and its settings into one JSON text, and unpacks it.
#include "chimera/manager/state/bundle.h"

#include "chimera/catalogue/descriptor_json.h"
#include "chimera/load/utf8.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

constexpr int kVersion = 1;

/// The bundle treats texts as bytes: text that is not UTF-8 is written as one code point for each byte.
Json text_json(const std::string& text) {
  if (is_utf8(text)) return text;
  Json bytes = Json::array();
  for (const char c : text) bytes.push_back(static_cast<unsigned char>(c));
  return bytes;
}

std::string text_of(const Json& json) {
  if (json.is_string()) return json.as_string();
  std::string text;
  for (const Json& byte : json) text += static_cast<char>(byte.as_uint64());
  return text;
}

void put_group(Json& groups, const char* role, const std::optional<std::uint32_t>& group) {
  if (group) groups[role] = *group;
}

std::optional<std::uint32_t> group_of(const Json& groups, const char* role) {
  const Json* found = groups.find(role);
  return found == nullptr ? std::nullopt : std::optional(static_cast<std::uint32_t>(found->as_uint64()));
}

Error refused(std::string_view why, std::string_view where = "bundle") { return {ErrorCode::kBadInput, why, where}; }

Result<Library> library_of(const Json& json) {
  auto units = UnitSystem::of(text_of(json.at("units").at("text")), text_of(json.at("units").at("file")));
  if (!units) return units.error();
  std::vector<LibraryEntry> entries;
  for (const Json& component : json.at("components")) {
    const std::string file = text_of(component.at("file"));
    auto descriptor = parse_descriptor(text_of(component.at("descriptor")));
    if (!descriptor) return refused(descriptor.error().message.view(), file);
    entries.push_back({*std::move(descriptor), file, text_of(component.at("object"))});
  }
  Library library = Library::of_entries(std::move(entries), *std::move(units));
  if (!library.faults().empty()) return library.faults()[0];
  return library;
}

Result<Bundle> read(const Json& json) {
  if (json.at("version") != kVersion)
    return refused("version " + json.at("version").dump() + ", this program reads " + std::to_string(kVersion));
  auto library = library_of(json);
  if (!library) return library.error();
  const Json& groups = json.at("groups");
  std::vector<Setting> settings;
  for (const Json& setting : json.at("settings")) {
    const std::string name = text_of(setting.at("name"));
    settings.push_back({name, text_of(setting.at("value")), name});
  }
  return Bundle{text_of(json.at("program")), text_of(json.at("file")), text_of(json.at("description")),
                group_of(groups, "observe"), group_of(groups, "operate"), group_of(groups, "configure"),
                *std::move(library), std::move(settings)};
}

}  // namespace

std::string encode(const Bundle& bundle) {
  Json components = Json::array();
  for (const LibraryEntry& entry : bundle.library.entries())
    components.push_back({{"descriptor", text_json(to_json(entry.descriptor))},
                          {"file", text_json(entry.descriptor_file)},
                          {"object", text_json(entry.object_file)}});
  Json settings = Json::array();
  for (const Setting& setting : bundle.settings)
    settings.push_back({{"name", text_json(setting.name)}, {"value", text_json(setting.value)}});
  Json groups = Json::object();
  put_group(groups, "observe", bundle.observe_group);
  put_group(groups, "operate", bundle.operate_group);
  put_group(groups, "configure", bundle.configure_group);
  const UnitSystem& units = bundle.library.units();
  return Json{{"version", kVersion},
              {"program", text_json(bundle.program)},
              {"file", text_json(bundle.file)},
              {"description", text_json(bundle.description)},
              {"settings", std::move(settings)},
              {"groups", std::move(groups)},
              {"units", {{"file", text_json(units.file())}, {"text", text_json(units.text())}}},
              {"components", std::move(components)}}
      .dump();
}

Result<Bundle> decode_bundle(std::string_view text) {
  text = text.substr(0, std::min(text.find('\0'), text.size()));
  try {
    return read(Json::parse(text));
  } catch (const std::exception& error) {
    return refused(error.what());
  }
}

Verdict verify(const Bundle& bundle) {
  Verdict verdict = chimera::verify(read_description(bundle.description, bundle.file), bundle.library);
  if (!verdict.configuration) return verdict;
  auto set = with_settings(*verdict.configuration, bundle.library, bundle.settings);
  if (set) {
    verdict.configuration = *std::move(set);
    return verdict;
  }
  verdict.configuration.reset();
  verdict.report.add({.rule = "quantity-bad", .message = std::string(set.error().message.view())});
  return verdict;
}

}  // namespace chimera::manager
