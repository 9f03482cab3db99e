// SPDX-License-Identifier: Apache-2.0
// The draft of a description beside its file FILE, which other programs may change too. docs/formats/web.md, "The
// draft". Decisions only: draft_file.h reads and writes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace chimera::web {

/// FILE as it was read. Plain value.
struct FileNow {
  bool exists = false;
  std::string text = {};     ///< "" if there is no FILE, or if it cannot be read
  std::string problem = {};  ///< why FILE cannot be read; "": it can be read, or there is none

  bool is_read() const noexcept { return exists && problem.empty(); }
  bool operator==(const FileNow&) const = default;
};

/// A draft in the state folder. Plain value.
struct KeptText {
  std::string text;
  std::optional<std::string> base;  ///< the text of FILE that the draft replaces; none: there was no FILE

  bool operator==(const KeptText&) const = default;
};

/// The draft is own if a person made its text and FILE does not have that text. Only a draft that is not own follows
/// FILE. Context: setup.
class PageDraft {
 public:
  /// Begins with the text of `file`, or goes on with the kept draft. The version is 1.
  explicit PageDraft(FileNow file, std::optional<KeptText> kept = {});

  const std::string& text() const noexcept { return text_; }
  std::uint64_t version() const noexcept { return version_; }
  const FileNow& file() const noexcept { return file_; }
  /// The text is not that of FILE.
  bool is_touched() const noexcept { return text_ != file_.text; }
  /// Another program changed FILE after a person changed the draft: a person decides between the two.
  bool is_outside() const noexcept { return is_own_ && file_.problem.empty() && is_touched() && present() != base_; }
  /// The text for the state folder; none: FILE has the text.
  std::optional<KeptText> to_keep() const;

  /// FILE was read again. An empty or missing FILE, and one that cannot be read, changes no text of the draft.
  void see(FileNow file);
  /// A person changed the text.
  void change(std::string text);
  /// FILE was replaced by the text.
  void written();
  /// A person keeps the draft: it replaces FILE as it is now. Requires no problem of FILE.
  void keep_draft() { base_ = present(); }
  /// A person takes the text of FILE. Requires file().is_read().
  void keep_file();

 private:
  std::optional<std::string> present() const { return file_.exists ? std::optional(file_.text) : std::nullopt; }
  void follow();
  void settle();

  std::string text_;
  std::uint64_t version_ = 1;
  FileNow file_;
  std::optional<std::string> base_;
  bool is_own_ = false;
};

}  // namespace chimera::web
