// SPDX-License-Identifier: Apache-2.0
// Lists the documents of a folder once; reads no file under a name that is not in this list.
#include "chimera/web/documents.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>

#include "chimera/base/hosted/ordinary_file.h"

namespace chimera::web {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostFiles = 4000, kMostText = std::size_t{1} << 20, kMostPicture = std::size_t{4} << 20;
constexpr std::array<std::string_view, 12> kTexts = {".md",  ".yaml", ".cc",   ".c",    ".h",     ".csv",
                                                     ".txt", ".xml",  ".json", ".urdf", ".store", ".events"};

bool is_document(const fs::path& path) {
  const std::string kind = path.extension().string();
  return std::find(kTexts.begin(), kTexts.end(), kind) != kTexts.end() || !Documents::picture_type(kind).empty();
}

/// Adds the files below `top`, whose names begin behind `above`. Does not follow symbolic links.
void list(const fs::path& top, std::size_t above, std::vector<std::string>& names) {
  std::error_code error;
  fs::recursive_directory_iterator at(top, fs::directory_options::skip_permission_denied, error);
  for (; !error && at != fs::recursive_directory_iterator() && names.size() < kMostFiles; at.increment(error)) {
    std::error_code gone;
    const bool is_hidden = at->path().filename().string().starts_with(".");
    if (is_hidden && at->is_directory(gone)) at.disable_recursion_pending();
    if (!is_hidden && fs::is_regular_file(at->symlink_status(gone)) && is_document(at->path()))
      names.push_back(at->path().string().substr(above));
  }
}

}  // namespace

Documents Documents::in(const std::string& folder) {
  Documents made;
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return made;
  made.folder_ = root.string();
  const std::size_t above = made.folder_.size() + 1;
  for (const char* name : {"README.md", "CONTRIBUTING.md"})
    if (fs::is_regular_file(fs::symlink_status(root / name, error))) made.names_.emplace_back(name);
  for (const char* name : {"docs", "examples", "library"})
    if (fs::is_directory(fs::symlink_status(root / name, error))) list(root / name, above, made.names_);
  std::sort(made.names_.begin(), made.names_.end());
  for (const std::string& name : made.names_) {
    if (!name.ends_with(".md")) continue;
    if (const auto text = made.read(name)) made.titles_.emplace(name, title_of(*text));
  }
  return made;
}

bool Documents::has(std::string_view name) const { return std::binary_search(names_.begin(), names_.end(), name); }

std::string_view Documents::picture_type(std::string_view name) noexcept {
  return name.ends_with(".svg") ? "image/svg+xml" : name.ends_with(".png") ? "image/png" : "";
}

Result<std::string> Documents::read(std::string_view name) const {
  if (!has(name)) return Message("no such document").error(ErrorCode::kNotFound, name);
  const std::string path = folder_ + "/" + std::string(name);
  std::error_code error;
  if (const fs::path real = fs::canonical(path, error); !error && real != path)
    return Message("is reached through a symbolic link").error(ErrorCode::kRefused, name);
  const std::size_t most = picture_type(name).empty() ? kMostText : kMostPicture;
  auto bytes = read_ordinary(path, most + 1);
  if (bytes && bytes->size() > most)
    return (Message("has more than ") << most << " bytes").error(ErrorCode::kRefused, name);
  return bytes;
}

std::string title_of(std::string_view markdown) {
  while (!markdown.empty()) {
    const std::string_view line = markdown.substr(0, markdown.find('\n'));
    if (line.starts_with("# ")) return std::string(line.substr(2));
    markdown.remove_prefix(std::min(markdown.size(), line.size() + 1));
  }
  return "";
}

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  std::uint32_t held = 0;
  int n_held = 0;
  for (const char byte : bytes) {
    held = held << 8 | static_cast<unsigned char>(byte);
    for (n_held += 8; n_held >= 6; n_held -= 6) text += kDigits[held >> (n_held - 6) & 63u];
  }
  if (n_held > 0) text += kDigits[held << (6 - n_held) & 63u];
  while (text.size() % 4 != 0) text += '=';
  return text;
}

}  // namespace chimera::web
