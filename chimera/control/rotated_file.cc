// SPDX-License-Identifier: Apache-2.0
// Files each line once, and reads the last of them.
#include "chimera/control/rotated_file.h"

#include <algorithm>
#include <filesystem>
#include <unordered_set>
#include <utility>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/platform/file.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

constexpr std::size_t kTail = std::size_t{2} << 20;  // holds all that a manager may have filed and not noted

/// Calls `visit` for each whole line of `text`, the last one first, until it returns false.
template <class Visit>
void visit_back(std::string_view text, Visit&& visit) {
  for (std::size_t end = text.rfind('\n'); end != text.npos;) {
    const std::size_t before = end == 0 ? text.npos : text.rfind('\n', end - 1), begin = before + 1;  // npos + 1 is 0
    if (!visit(text.substr(begin, end - begin))) return;
    end = before;
  }
}

std::string all_of(const std::string& path) {
  auto text = read_ordinary(path, std::size_t{2} * RotatedFile::kMostBytes);
  return text ? *std::move(text) : "";
}

}  // namespace

std::string_view line_key(std::string_view line) noexcept {
  const std::size_t first = line.find(", ");
  const std::size_t second = first == line.npos ? line.npos : line.find(", ", first + 2);
  return second == line.npos ? line : line.substr(0, second + 2);
}

Result<void> RotatedFile::file(const std::vector<std::string>& lines) {
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(folder_).parent_path(), error);
  (void)make_private_folder(folder_);  // not made: the file in it is not either, and says why
  const bool was_known = std::exchange(is_known_, false);  // until all of it is on the disk
  auto file = LineFile::open(path());
  if (!file) return file.error();
  const std::string before = was_known ? "" : all_of(path_before()), tail = was_known ? "" : file->tail(kTail);
  std::unordered_set<std::string_view> known;
  for (const std::string_view text : {std::string_view(before), std::string_view(tail)})
    visit_back(text, [&](std::string_view line) { return known.insert(line_key(line)), true; });
  std::string text;
  for (const std::string& line : lines)
    if (!known.contains(line_key(line))) text += line + "\n";
  if (!text.empty() && file->bytes() > 0 && file->bytes() + text.size() > most_) {
    if (const auto renamed = file->rename_to(path_before()); !renamed) return renamed.error();
    file = LineFile::open(path());
    if (!file) return file.error();
  }
  if (!text.empty())
    if (const auto appended = file->append(text); !appended) return appended.error();
  is_known_ = true;
  return {};
}

std::vector<std::string> RotatedFile::last(std::size_t n, std::string_view run) const {
  std::vector<std::string> lines;
  for (const std::string& name : {path(), path_before()}) {
    if (lines.size() >= n) break;
    visit_back(all_of(name), [&](std::string_view line) {
      const bool is_one = line.starts_with("{\"number\": ") && line_key(line).ends_with(run);
      if (is_one && Json::parse_or_none(line)) lines.emplace_back(line);
      return lines.size() < n;
    });
  }
  std::ranges::reverse(lines);
  return lines;
}

}  // namespace chimera::control
