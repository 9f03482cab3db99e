// SPDX-License-Identifier: Apache-2.0
// A JSON value and all that it contains. Light to include: only json.cc sees the library that parses.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chimera {

/// Thrown for a text that is no JSON, for a key that is missing, and for a value of another kind than the caller reads.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The kind of value that a Json is.
class JsonKind {
 public:
  bool is_null() const noexcept { return kind_ == Kind::kNull; }
  bool is_bool() const noexcept { return kind_ == Kind::kBool; }
  bool is_whole() const noexcept { return kind_ == Kind::kInt64 || kind_ == Kind::kUint64; }
  bool is_number() const noexcept { return is_whole() || kind_ == Kind::kDouble; }
  bool is_string() const noexcept { return kind_ == Kind::kString; }
  bool is_array() const noexcept { return kind_ == Kind::kArray; }
  bool is_object() const noexcept { return kind_ == Kind::kObject; }

 protected:
  // A kUint64 is above INT64_MAX. From kString on the value is on the heap.
  enum class Kind : std::uint8_t { kNull, kBool, kInt64, kUint64, kDouble, kString, kArray, kObject };

  explicit JsonKind(Kind kind) noexcept : kind_(kind) {}

  mutable Kind kind_;  // see Json(std::initializer_list)
};

/// One JSON value with value semantics; a copy is deep. References to members of an object stay valid while it grows,
/// references to elements of an array do not. Context: setup.
class Json : public JsonKind {
 public:
  using Member = std::pair<const std::string, Json>;
  class Members;
  enum class Style {
    kDense,   ///< one line, keys by their bytes: {"a":1,"b":[2,3]}
    kAsMade,  ///< one line, keys in the order in which they were added: {"b":[2,3],"a":1}
    kSpaced,  ///< the same with spaces: {"b": [2, 3], "a": 1}
    kLines,   ///< the same on lines of their own, two columns in for each level
  };

  Json(std::nullptr_t = nullptr) noexcept : JsonKind(Kind::kNull) {}
  Json(bool value) noexcept : JsonKind(Kind::kBool) { value_.truth = value; }
  Json(int value) noexcept : Json(static_cast<long long>(value)) {}
  Json(unsigned value) noexcept : Json(static_cast<long long>(value)) {}
  Json(long value) noexcept : Json(static_cast<long long>(value)) {}
  Json(unsigned long value) noexcept : Json(static_cast<unsigned long long>(value)) {}
  Json(long long value) noexcept : JsonKind(Kind::kInt64) { value_.int64 = value; }
  Json(unsigned long long value) noexcept;
  Json(double value) noexcept : JsonKind(Kind::kDouble) { value_.number = value; }
  Json(const char* text) : Json(std::string(text)) {}
  Json(std::string_view text) : Json(std::string(text)) {}
  Json(std::string text);
  Json(std::vector<Json> elements);
  Json(const std::vector<std::string>& texts);
  Json(const void*) = delete;  // a pointer is no truth value
  /// An object if every item is an array of a text and a value ({{"a", 1}, {"b", 2}}), else an array. Takes the values
  /// out of `items`.
  Json(std::initializer_list<Json> items);
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(Json other) noexcept;
  ~Json();

  static Json array(std::initializer_list<Json> elements = {});
  static Json object();
  /// Throws JsonError for what is no JSON, holds a number beyond every double, or nests deeper than 500. Of equal keys
  /// in one object the last counts; `twice` gets the first such key.
  static Json parse(std::string_view text, std::optional<std::string>* twice = nullptr);
  /// As parse(); none in place of JsonError.
  static std::optional<Json> parse_or_none(std::string_view text, std::optional<std::string>* twice = nullptr);
  /// Bytes that are no UTF-8 become U+FFFD, numbers that are not finite become null.
  std::string dump(Style style = Style::kDense) const;

  /// Each throws JsonError for another kind. A number is converted: a fraction is cut off, a number beyond the range
  /// becomes its limit.
  bool as_bool() const;
  std::int64_t as_int64() const;
  std::uint64_t as_uint64() const;
  double as_double() const;
  const std::string& as_string() const;
  std::vector<std::string> as_strings() const;

  /// Elements of an array or members of an object; 0 for all others.
  std::size_t size() const noexcept;
  bool empty() const noexcept { return size() == 0; }

  /// Null if there is no such key or element.
  const Json& operator[](std::string_view key) const noexcept;
  const Json& operator[](std::size_t i) const noexcept;
  /// A null becomes an object, a missing key is added with null. Throws JsonError for a value that is no object.
  Json& operator[](std::string_view key);
  /// Requires an array with that element, else throws JsonError.
  Json& operator[](std::size_t i);
  /// Throws JsonError if the key is missing.
  const Json& at(std::string_view key) const;
  /// Null pointer if the key is missing.
  const Json* find(std::string_view key) const noexcept;
  bool contains(std::string_view key) const noexcept { return find(key) != nullptr; }

  /// The elements of an array; none of all others.
  const Json* begin() const noexcept;
  const Json* end() const noexcept { return begin() + (is_array() ? size() : 0); }
  /// Throws JsonError for a value that is no array.
  std::vector<Json>& elements();
  /// A null becomes an array. Throws JsonError for a value that is no array.
  void push_back(Json element);
  /// The members of an object by key; none of all others.
  Members items() const noexcept;

  /// Numbers are equal if their values are. The order of keys does not matter.
  friend bool operator==(const Json& a, const Json& b) noexcept;
  friend std::ostream& operator<<(std::ostream& out, const Json& json);

 private:
  struct Object;
  class Parser;
  class Writer;

  mutable union {
    std::uint64_t uint64;
    std::int64_t int64;
    bool truth;
    double number;
    std::string* text;
    std::vector<Json>* elements;
    Object* object;
  } value_ = {};
};

/// For `for (const auto& [key, value] : json.items())`. The object outlives its Members and does not change during the
/// loop.
class Json::Members {
 public:
  class Iterator {
   public:
    explicit Iterator(const Member* const* at) noexcept : at_(at) {}
    const Member& operator*() const noexcept { return **at_; }
    Iterator& operator++() noexcept { return ++at_, *this; }
    bool operator==(const Iterator&) const = default;

   private:
    const Member* const* at_;
  };

  Members(const Member* const* first, std::size_t n) noexcept : first_(first), n_(n) {}
  Iterator begin() const noexcept { return Iterator(first_); }
  Iterator end() const noexcept { return Iterator(first_ + n_); }

 private:
  const Member* const* first_;
  std::size_t n_;
};

/// A member of `object`, or `otherwise` if it is missing or of another kind.
std::string text_at(const Json& object, std::string_view key, const char* otherwise = "");
std::int64_t whole_at(const Json& object, std::string_view key, std::int64_t otherwise = 0);
bool truth_at(const Json& object, std::string_view key, bool otherwise = false);

}  // namespace chimera
