// SPDX-License-Identifier: Apache-2.0
// Files receipts once each, and reads the last of them.
#include "chimera/control/receipt/receipt_file.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/platform/file.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

constexpr std::size_t kTail = std::size_t{2} << 20;  // holds whatever a manager may have filed and not noted

bool has_line(std::string_view lines, std::string_view key) {
  for (std::size_t at = 0; (at = lines.find(key, at)) != std::string_view::npos; ++at)
    if (at == 0 || lines[at - 1] == '\n') return true;
  return false;
}

/// Whole lines of receipts, without lines that another program has written there.
std::vector<std::string> receipts_in(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0, end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    std::string line = text.substr(begin, end - begin);
    if (line.starts_with("{\"number\": ") && Json::parse_or_none(line)) lines.push_back(std::move(line));
  }
  return lines;
}

std::string all_of(const std::string& path) {
  auto text = read_ordinary(path, std::size_t{2} * ReceiptFile::kMostBytes);
  return text ? *std::move(text) : "";
}

}  // namespace

std::string_view receipt_key(std::string_view line) noexcept {
  const std::size_t first = line.find(", ");
  const std::size_t second = first == line.npos ? line.npos : line.find(", ", first + 2);
  return second == line.npos ? line : line.substr(0, second + 2);
}

Result<void> ReceiptFile::file(const std::vector<std::string>& receipts) {
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(folder_).parent_path(), error);
  (void)make_private_folder(folder_);  // not made: the file in it is not either, and says why
  const bool was_known = std::exchange(is_known_, false);  // until all of it is on the disk
  auto file = LineFile::open(path());
  if (!file) return file.error();
  const std::string known = was_known ? "" : all_of(path_before()) + file->tail(kTail);
  std::string lines;
  for (const std::string& receipt : receipts)
    if (!has_line(known, receipt_key(receipt))) lines += receipt + "\n";
  if (lines.empty()) return {};
  if (file->bytes() >= most_) {
    if (const auto renamed = file->rename_to(path_before()); !renamed) return renamed.error();
    file = LineFile::open(path());
    if (!file) return file.error();
  }
  if (const auto appended = file->append(lines); !appended) return appended.error();
  is_known_ = true;
  return {};
}

std::vector<std::string> ReceiptFile::last(std::size_t n) const {
  std::vector<std::string> all = receipts_in(all_of(path()));
  if (all.size() < n) {
    const std::vector<std::string> before = receipts_in(all_of(path_before()));
    all.insert(all.begin(), before.begin(), before.end());
  }
  if (all.size() > n) all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(n));
  return all;
}

}  // namespace chimera::control
