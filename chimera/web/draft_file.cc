// SPDX-License-Identifier: Apache-2.0
// Reads and writes FILE and the kept draft, each whole or not at all.
#include "chimera/web/draft_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/description/text_limits.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process_state.h"
#include "chimera/platform/socket_place.h"
#include "chimera/text/json.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;

/// Two changes within this time may have one time stamp: a clock tick of the file system, and some more.
constexpr std::int64_t kSettled = 100'000'000;
constexpr std::size_t kMaxKept = std::size_t{4} << 20;  // both texts with every byte escaped, and the path
constexpr int kMaxAside = 1000;

std::int64_t wall_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// FNV-1a: equal for the same text in every process.
std::string sum_of(std::string_view text) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(sum));
  return digits;
}

std::string sentence_of(const Error& error) {
  return std::string(error.where.view()) + ": " + std::string(error.message.view());
}

std::string content_of(const std::string& file, const KeptText& kept) {
  Json head = Json::object();
  head["chimera_draft"] = 1;
  head["file"] = file;
  head["base"] = kept.base ? Json(*kept.base) : Json();
  head["sum"] = sum_of(kept.text);
  return head.dump(Json::Style::kAsMade) + "\n" + kept.text;
}

/// None with the reason if it is not a kept draft of `file`.
std::optional<KeptText> kept_in(std::string_view content, const std::string& file, std::string& why) {
  const std::size_t end = content.find('\n');
  const auto head = Json::parse_or_none(content.substr(0, end));
  why = "is no kept draft";
  if (end == std::string_view::npos || !head || !head->is_object() || whole_at(*head, "chimera_draft") != 1)
    return std::nullopt;
  why = "is the draft of " + text_at(*head, "file");
  if (text_at(*head, "file") != file) return std::nullopt;
  KeptText kept{std::string(content.substr(end + 1)), {}};
  why = "is damaged";
  const Json* base = head->find("base");
  if (base == nullptr || !(base->is_null() || base->is_string()) || text_at(*head, "sum") != sum_of(kept.text) ||
      !text_problem(kept.text).empty())
    return std::nullopt;
  if (base->is_string()) kept.base = base->as_string();
  return kept;
}

}  // namespace

Result<void> make_drafts_folder(const std::string& folder) {
  if (folder.empty())
    return Message("is named neither by XDG_STATE_HOME nor by HOME").error(ErrorCode::kRefused, "the state folder");
  const fs::path above = fs::path(folder).parent_path();
  std::error_code error;
  fs::create_directories(above.parent_path(), error);
  if (!make_private_folder(above.string()) || !make_private_folder(folder) || !is_safe_folder(folder.c_str()))
    return Message("is no folder of this user alone, or cannot be made").error(ErrorCode::kRefused, folder);
  fs::permissions(folder, fs::perms::owner_all, error);
  return {};
}

std::string text_problem(std::string_view text) {
  Report report;
  (void)check_text_limits(text, report);  // of the other limits the analysis speaks
  for (const Fault& fault : report.faults())
    if (fault.rule == "text-size" || fault.rule == "text-encoding") return fault.message;
  return "";
}

FileNow DraftFile::read() {
  std::error_code error;
  state_ = state_of_file(path_);
  is_settled_ = state_ && wall_now() - state_->changed_ns > kSettled;
  const fs::file_status status = fs::status(path_, error);
  if (status.type() == fs::file_type::not_found) {
    is_settled_ = true;
    if (fs::symlink_status(path_, error).type() == fs::file_type::symlink)
      return {true, "", path_ + ": is a link to a file that is not there"};
    return {};
  }
  if (status.type() == fs::file_type::none) return {true, "", path_ + ": cannot be read: " + error.message()};
  auto text = read_ordinary(path_, kMaxTextBytes + 1);
  if (!text && text.error().code == ErrorCode::kNotFound) return {};  // it went after the look at its status
  if (!text) return {true, "", sentence_of(text.error())};
  if (const std::string why = text_problem(*text); !why.empty()) return {true, "", path_ + ": " + why};
  return {true, *std::move(text), ""};
}

std::optional<FileNow> DraftFile::read_changed(Nanoseconds now) {
  if (now - looked_at_ < kPeriod) return std::nullopt;
  looked_at_ = now;
  if (is_settled_ && state_of_file(path_) == state_) return std::nullopt;
  return read();
}

Result<void> DraftFile::write(const std::string& text) {
  if (!state_) {
    auto part = PartFile::open(path_);
    if (!part) return part.error();
    if (auto put = part->put_new(text); !put) return put;
  } else {
    std::error_code error;
    const fs::path real = fs::canonical(path_, error);
    if (error) return Message("cannot be written: " + error.message()).error(ErrorCode::kSystem, path_);
    if (auto replaced = replace_file(real.string(), *state_, text); !replaced) return replaced;
  }
  state_ = state_of_file(path_);
  is_settled_ = false;
  return {};
}

KeptDraft::KeptDraft(std::string folder, std::string file, std::function<void(const std::string&)> tell)
    : folder_(std::move(folder)), file_(std::move(file)), tell_(std::move(tell)) {
  std::string name = fs::path(file_).filename().string().substr(0, 100);
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') c = '_';
  path_ = folder_ + "/" + name + "-" + sum_of(file_);
}

/// From now on no other process keeps this draft.
Result<void> KeptDraft::claim() {
  if (claim_.fd >= 0) return {};
  if (auto made = make_drafts_folder(folder_); !made) return made;
  const std::string name = "chimera-draft-" + std::to_string(own_user()) + "-" + sum_of(path_);
  claim_ = claim_name(name);
  if (claim_.fd >= 0) return remove_parts(), Result<void>();
  const int process = errno == EADDRINUSE ? holder_of_name(name).process : 0;
  return (Message() << "another chimera web (process " << process << ") keeps the draft of this file")
      .error(ErrorCode::kRefused, path_);
}

/// Removes the parts of files of a process that was killed while it wrote.
void KeptDraft::remove_parts() const {
  const std::string name = fs::path(path_).filename().string() + ".";
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    const std::string found = at->path().filename().string();
    std::error_code ignored;
    if (found.starts_with(name) && (found.size() == name.size() + 6 || found.ends_with(".part")))
      fs::remove(at->path(), ignored);
  }
}

void KeptDraft::set_aside(const std::string& why) {
  std::error_code error;
  int number = 1;
  while (number < kMaxAside && fs::exists(fs::symlink_status(path_ + "-aside-" + std::to_string(number), error)))
    ++number;
  const std::string place = path_ + "-aside-" + std::to_string(number);
  fs::rename(path_, place, error);
  const std::string said = "the file of an earlier draft " + why + ": it is " + (error ? path_ : place) + " now";
  if (said != aside_) tell_(said);
  aside_ = said;
}

std::optional<KeptText> KeptDraft::read() {
  state_.reset();
  std::error_code error;
  const fs::file_type type = fs::symlink_status(path_, error).type();
  if (folder_.empty() || type == fs::file_type::not_found || !claim()) return std::nullopt;
  std::string why = "is no ordinary file";
  if (type == fs::file_type::regular) {
    state_ = state_of_file(path_);
    const auto content = read_ordinary(path_, kMaxKept + 1);
    if (content)
      if (auto kept = kept_in(*content, file_, why)) return kept;
    if (!content) why = content.error().message.c_str();
  }
  state_.reset();
  set_aside(why);
  return std::nullopt;
}

Result<void> KeptDraft::keep(const std::optional<KeptText>& kept) {
  if (!kept && !state_) return {};  // this process has kept nothing, so nothing of its own is there
  if (auto claimed = claim(); !claimed) return claimed;
  if (kept) return put(content_of(file_, *kept));
  std::error_code error;
  if (state_of_file(path_) == state_) fs::remove(path_, error);
  state_.reset();
  if (error) return Message("cannot be removed: " + error.message()).error(ErrorCode::kSystem, path_);
  return {};
}

Result<void> KeptDraft::put(const std::string& content) {
  std::error_code error;
  const auto there = fs::symlink_status(path_, error).type();
  if (there != fs::file_type::not_found && (there != fs::file_type::regular || state_of_file(path_) != state_))
    set_aside("was changed by another program");
  if (there != fs::file_type::regular || !state_ || state_of_file(path_) != state_) {
    auto part = PartFile::open(path_, 0600);
    if (!part) return part.error();
    if (auto made = part->put_new(content); !made) return made;
  } else if (auto replaced = replace_file(path_, *state_, content); !replaced) {
    return replaced;
  }
  state_ = state_of_file(path_);
  return {};
}

}  // namespace chimera::web
