// SPDX-License-Identifier: Apache-2.0
// The files of the draft: FILE itself, and the kept draft in the state folder. docs/formats/web.md, "The draft".
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "chimera/base/time.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/file.h"
#include "chimera/web/page_draft.h"

namespace chimera::web {

/// Makes the folder of kept drafts, for this user alone. Refuses, with the path in `where`. Context: setup; may block.
Result<void> make_drafts_folder(const std::string& folder);

/// "" for a text that a description may be; else why it is none, as "has more than 262144 bytes". Context: setup.
std::string text_problem(std::string_view text);

/// FILE, which other programs replace by another file or rewrite in place. Context: setup; may block on the disk.
class DraftFile {
 public:
  static constexpr Nanoseconds kPeriod = milliseconds(500);  ///< of looks at its state

  explicit DraftFile(std::string path) : path_(std::move(path)) {}

  const std::string& path() const noexcept { return path_; }
  FileNow read();
  /// Reads FILE if it seems to have changed since the last read(), at most once in kPeriod; else none.
  std::optional<FileNow> read_changed(Nanoseconds now);
  /// Replaces FILE as read() found it last, or makes it; a link stays a link. Refuses, with the path in `where`, if
  /// another program changed or made FILE since.
  Result<void> write(const std::string& text);

 private:
  std::string path_;
  std::optional<FileState> state_;
  bool is_settled_ = false;  // a change after read() would show in the state
  Nanoseconds looked_at_{INT64_MIN / 2};
};

/// The kept draft of one FILE. Only one process at a time keeps it. Context: setup; may block on the disk.
class KeptDraft {
 public:
  /// `folder`: of kept drafts; "": there is none. `file`: from the root. `tell` gets a sentence for each file that is
  /// set aside.
  KeptDraft(std::string folder, std::string file, std::function<void(const std::string&)> tell);

  /// The draft of an earlier process. A file that is none is renamed.
  std::optional<KeptText> read();
  /// Replaces the file, or removes it (none), whole or not at all. Refuses, with the path in `where`.
  Result<void> keep(const std::optional<KeptText>& kept);
  const std::string& path() const noexcept { return path_; }
  /// The last file that was set aside, as a sentence; "": none.
  const std::string& aside() const noexcept { return aside_; }

 private:
  Result<void> claim();
  Result<void> put(const std::string& content);
  void set_aside(const std::string& why);
  void remove_parts() const;

  std::string folder_, file_, path_;
  std::function<void(const std::string&)> tell_;
  OwnedDescriptor claim_;
  std::optional<FileState> state_;  // of the file that this process wrote or read
  std::string aside_;
};

}  // namespace chimera::web
