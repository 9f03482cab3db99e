// SPDX-License-Identifier: Apache-2.0
// Reads the folders of components and finds components in them.
#include "chimera/catalogue/library.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/descriptor_json.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

constexpr std::string_view kSuffix = ".component.json";
constexpr std::size_t kMostBuildableBytes = 1 << 20;

Error unit_fault(const std::string& place, const Error& error, const std::string& file) {
  const std::string text = place + ": " + std::string(error.message.view());
  return {ErrorCode::kBadInput, std::string_view(text), std::string_view(file)};
}

/// "is no folder"; "" for a folder that can be read.
std::string unreadable(const std::string& folder) {
  std::error_code failed;
  const std::filesystem::directory_iterator first(folder, failed);
  if (!failed) return "";
  const bool is_none = failed == std::errc::no_such_file_or_directory || failed == std::errc::not_a_directory;
  return is_none ? "is no folder" : "cannot be read: " + failed.message();
}

/// Refuses the first unit of `descriptor` that is unknown.
Result<void> check_units(const LibraryEntry& entry, const UnitSystem& units) {
  for (const PortDescriptor& port : entry.descriptor.ports) {
    const std::string place = "component " + entry.descriptor.name + ": port " + port.name;
    if (const auto unit = units.parse_expression(port.unit); !unit) {
      return unit_fault(place, unit.error(), entry.descriptor_file);
    }
    for (const FieldDescriptor& field : port.fields) {
      const auto unit = units.parse(field.unit);
      if (!unit) return unit_fault(place + ": field " + field.name, unit.error(), entry.descriptor_file);
    }
  }
  return {};
}

}  // namespace

Library Library::make(std::span<const std::string> folders, UnitSystem units) {
  Library library(std::move(units));
  for (auto folder = folders.begin(); folder != folders.end(); ++folder) {
    const auto is_same = [&](const std::string& other) {
      std::error_code unknown;
      return std::filesystem::equivalent(*folder, other, unknown);
    };
    if (std::none_of(folders.begin(), folder, is_same)) library.read_folder(*folder);  // CHIMERA_PATH may repeat it
  }
  for (const std::string& folder : component_folders({}))
    if (const std::string why = unreadable(folder); !why.empty())
      library.missing_folders_.push_back(folder + ", which " + why);
  return library;
}

Library Library::of(std::vector<Descriptor> descriptors, UnitSystem units) {
  Library library(std::move(units));
  for (Descriptor& descriptor : descriptors) library.add({std::move(descriptor), "", ""});
  return library;
}

Library Library::of_entries(std::vector<LibraryEntry> entries, UnitSystem units) {
  Library library(std::move(units));
  for (LibraryEntry& entry : entries) library.add(std::move(entry));
  return library;
}

void Library::read_folder(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code failed;
  for (std::filesystem::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string path = it->path().string();
    if (path.ends_with(kSuffix)) files.push_back(path);
  }
  const auto names = read_ordinary(folder + "/buildable.txt", kMostBuildableBytes);
  std::istringstream buildable(names ? *names : std::string());
  for (std::string name; std::getline(buildable, name);) buildable_.push_back(name);
  std::sort(files.begin(), files.end());  // a folder has no fixed order; the order of faults must be fixed
  for (const std::string& file : files) read_file(file);
}

void Library::read_file(const std::string& path) {
  auto descriptor = read_descriptor_file(path);
  if (!descriptor) {
    faults_.push_back(descriptor.error());
    return;
  }
  const std::string stem = path.substr(0, path.size() - kSuffix.size());
  const std::string name = std::filesystem::path(stem).filename().string();
  if (descriptor->name != name) {
    const std::string why = "describes the component " + descriptor->name + ", expected " + name;
    faults_.push_back({ErrorCode::kBadInput, std::string_view(why), std::string_view(path)});
    return;
  }
  add({*std::move(descriptor), path, stem + ".so"});
}

void Library::add(LibraryEntry entry) {
  if (const auto sound = check_units(entry, units_); !sound) {
    faults_.push_back(sound.error());
    return;
  }
  const auto place =
      std::lower_bound(entries_.begin(), entries_.end(), entry.descriptor.name,
                       [](const LibraryEntry& e, const std::string& name) { return e.descriptor.name < name; });
  if (place != entries_.end() && place->descriptor.name == entry.descriptor.name) {
    std::error_code unknown;  // a link to the same file is not hidden
    if (!std::filesystem::equivalent(place->descriptor_file, entry.descriptor_file, unknown))
      hidden_.push_back({entry.descriptor.name, entry.descriptor_file});
    return;
  }
  entries_.insert(place, std::move(entry));
}

const LibraryEntry* Library::find(std::string_view name) const noexcept {
  for (const LibraryEntry& entry : entries_) {
    if (entry.descriptor.name == name) return &entry;
  }
  return nullptr;
}

bool Library::is_unbuilt(std::string_view name) const noexcept {
  return find(name) == nullptr && std::find(buildable_.begin(), buildable_.end(), name) != buildable_.end();
}

std::size_t Library::n_unbuilt() const noexcept {
  const auto is_missing = [this](const std::string& name) { return find(name) == nullptr; };
  return static_cast<std::size_t>(std::count_if(buildable_.begin(), buildable_.end(), is_missing));
}

std::string Library::nearest_name(std::string_view name) const {
  return nearest(name, names_of(entries_, [](const LibraryEntry& entry) { return entry.descriptor.name; }));
}

std::vector<std::string> component_folders(std::span<const std::string> installed) {
  std::vector<std::string> folders;
  const char* path = std::getenv("CHIMERA_PATH");
  std::string_view rest = path == nullptr ? std::string_view() : std::string_view(path);
  while (!rest.empty()) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    if (colon > 0) folders.emplace_back(rest.substr(0, colon));
    rest.remove_prefix(std::min(colon + 1, rest.size()));
  }
  folders.insert(folders.end(), installed.begin(), installed.end());
  return folders;
}

}  // namespace chimera
