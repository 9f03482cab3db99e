// SPDX-License-Identifier: Apache-2.0
// Compares names and times of the folders of components, and packs the library for the analyst.
#include "chimera/web/bench_library.h"

#include <algorithm>

#include "chimera/manager/state/bundle.h"
#include "chimera/text/json.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;

Json list_of(const Library& library) {
  Json components = Json::array(), faults = Json::array();
  for (const LibraryEntry& entry : library.entries())
    components.push_back({{"name", entry.descriptor.name}, {"doc", entry.descriptor.doc}, {"file", entry.object_file}});
  for (const Error& fault : library.faults())
    faults.push_back({{"file", std::string(fault.where.view())}, {"message", std::string(fault.message.view())}});
  Json list = Json::object();
  list["components"] = std::move(components);
  list["faults"] = std::move(faults);
  return list;
}

}  // namespace

std::uint64_t BenchLibrary::version() {
  const Nanoseconds now = clock_.now();
  if (now - looked_at_ < kPeriod) return version_;
  looked_at_ = now;
  Stamp present = stamp();
  if (version_ > 0 && present == stamp_) return version_;
  stamp_ = std::move(present);
  ++version_;
  read();
  return version_;
}

BenchLibrary::Stamp BenchLibrary::stamp() const {
  Stamp found;
  std::vector<std::string> folders = workplace_.component_folders;
  if (!file_.empty()) folders.push_back((fs::path(file_).parent_path() / "build/components").string());
  std::error_code error;
  for (const std::string& folder : folders) {
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      const std::string name = at->path().filename().string();
      std::error_code gone;
      if (name.ends_with(".component.json") || name == "buildable.txt")
        found.emplace_back(at->path().string(), fs::last_write_time(at->path(), gone));
    }
  }
  for (const std::string& file : workplace_.unit_files) found.emplace_back(file, fs::last_write_time(file, error));
  std::sort(found.begin(), found.end());
  return found;
}

void BenchLibrary::read() {
  bundle_ = Error{};
  list_ = nullptr;
  auto library = workplace_.library(file_);
  if (!library) {
    bundle_ = library.error();
    return;
  }
  list_ = std::make_shared<const std::string>(list_of(*library).dump());
  const std::string packed = manager::encode({.program = program_,
                                              .file = "",
                                              .description = "",
                                              .observe_group = {},
                                              .operate_group = {},
                                              .configure_group = {},
                                              .library = *std::move(library)});
  bundle_ = FrozenBytes::create("bundle", std::as_bytes(std::span(packed)));
}

control::RpcResponse BenchLibrary::answer() const {
  if (list_ != nullptr) return control::RpcResponse::ready(list_);
  return control::RpcResponse::refused("library", bundle_.error().message.c_str(),
                                       std::string(bundle_.error().where.view()));
}

}  // namespace chimera::web
