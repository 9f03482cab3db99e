// SPDX-License-Identifier: Apache-2.0
// Strict reading of a JSON tree: every access says what it expects, every refusal names the path.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "chimera/text/json.h"

namespace chimera {

/// Thrown by JsonCursor and caught by the function that reads the document.
struct JsonRefusal {
  std::string message;
};

/// A value of the tree and its path ("$.ports[2].unit"). The tree outlives its cursors. Context: setup.
class JsonCursor {
 public:
  JsonCursor(const Json& value, std::string path) : value_(value), path_(std::move(path)) {}

  [[noreturn]] void refuse(std::string_view why) const { throw JsonRefusal{path_ + ": " + std::string(why)}; }

  /// Refuses anything but an object with all keys of `required` and no other than those and `optional`.
  void expect_keys(std::initializer_list<std::string_view> required,
                   std::initializer_list<std::string_view> optional) const;
  bool has(std::string_view key) const;
  JsonCursor at(std::string_view key) const;  ///< requires has(key)

  /// Elements of an array of at most `limit`.
  std::size_t size(std::size_t limit) const;
  JsonCursor at(std::size_t i) const;  ///< requires i < size()

  std::string text() const;
  bool truth() const;
  std::uint32_t whole() const;
  double number() const;  ///< or the words "inf" and "-inf"
  const Json& value() const { return value_; }

 private:
  const Json& value_;
  std::string path_;
};

/// The tree of `text`. Throws JsonRefusal for text above `bytes` or nested deeper than `nesting` (judged before
/// parsing), for what is no JSON, and for a key that comes twice in one object.
Json read_json(std::string_view text, std::size_t bytes, std::size_t nesting);

}  // namespace chimera
