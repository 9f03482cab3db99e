// SPDX-License-Identifier: Apache-2.0
// The files that the page may show: docs/formats/web.md, "Library and documents".
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"

namespace chimera::web {

/// Texts and pictures below one folder, by the names that were found when it was listed. Context: setup.
class Documents {
 public:
  /// Lists README.md, CONTRIBUTING.md, docs, examples and library of `folder`; a missing folder has no documents. May
  /// block.
  static Documents in(const std::string& folder);

  /// All names in alphabetical order.
  const std::vector<std::string>& names() const noexcept { return names_; }
  /// Names of Markdown texts, and their first headings.
  const std::map<std::string, std::string, std::less<>>& titles() const noexcept { return titles_; }
  bool has(std::string_view name) const;
  /// "image/png" of a picture, "" of a text.
  static std::string_view picture_type(std::string_view name) noexcept;
  /// The bytes of the file. Refuses a name that was not listed (kNotFound), a file that is now reached through a
  /// symbolic link, one that is not ordinary, and one beyond its limit. May block.
  Result<std::string> read(std::string_view name) const;

 private:
  std::string folder_;
  std::vector<std::string> names_;
  std::map<std::string, std::string, std::less<>> titles_;
};

/// The first heading of a Markdown text, "" without one.
std::string title_of(std::string_view markdown);
/// `bytes` in base64 (RFC 4648), with padding.
std::string base64(std::string_view bytes);

}  // namespace chimera::web
