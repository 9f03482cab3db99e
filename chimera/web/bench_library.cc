// SPDX-License-Identifier: Apache-2.0
// Compares names and times of the folders of components, and packs the library for the analyst.
#include "chimera/web/bench_library.h"

#include <algorithm>

#include "chimera/manager/state/bundle.h"
#include "chimera/text/json.h"

namespace chimera::web {
namespace fs = std::filesystem;

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
  library_ = std::nullopt;
  list_ = nullptr;
  auto library = workplace_.library(file_);
  if (!library) {
    bundle_ = library.error();
    return;
  }
  library_ = *library;
  const std::string packed = manager::encode({.program = program_,
                                              .file = "",
                                              .description = "",
                                              .observe_group = {},
                                              .operate_group = {},
                                              .configure_group = {},
                                              .library = *std::move(library)});
  bundle_ = FrozenBytes::create("bundle", std::as_bytes(std::span(packed)));
}

control::RpcResponse BenchLibrary::answer(control::MethodId method, const Json& parameters) {
  using control::MethodId;
  if (method == MethodId::kDocument) return pages_.document(parameters.at("name").as_string());
  if (!library_)
    return control::RpcResponse::refused("library", bundle_.error().message.c_str(),
                                         std::string(bundle_.error().where.view()));
  if (method == MethodId::kSheet) return pages_.sheet(*library_, parameters.at("component").as_string());
  if (method == MethodId::kValues)
    return pages_.values(*library_, parameters.at("component").as_string(), parameters.at("port").as_string());
  if (list_ == nullptr) list_ = std::make_shared<const std::string>(pages_.library(*library_).dump());
  return control::RpcResponse::ready(list_);
}

}  // namespace chimera::web
