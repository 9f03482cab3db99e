// SPDX-License-Identifier: Apache-2.0
// The secret of the link: a browser that knows it speaks for the user. docs/formats/web.md, "The link".
#pragma once

#include <string>
#include <string_view>

#include "chimera/base/result.h"

namespace chimera::web {

class PageKey {
 public:
  /// 256 random bits of the system. Refuses if the system gives none. Context: setup.
  static Result<PageKey> make();

  /// 43 characters of base64url.
  const std::string& text() const noexcept { return text_; }
  /// Compares in a time that does not depend on the bytes of `given`. Context: any; wait-free.
  bool is(std::string_view given) const noexcept;

 private:
  explicit PageKey(std::string text) noexcept : text_(std::move(text)) {}
  std::string text_;
};

}  // namespace chimera::web
