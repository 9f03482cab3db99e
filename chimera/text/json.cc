// SPDX-License-Identifier: Apache-2.0
// Keeps a tree of JSON values, and lets the library parse texts and write strings and fractions.
#include "chimera/text/json.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

namespace chimera {
namespace {

constexpr std::size_t kMostNesting = 500;  // functions of a tree call themselves for each level

const Json& null_json() noexcept {
  static const Json kNull;
  return kNull;
}

[[noreturn]] void refuse(const char* expected, const Json& found) {
  const char* what = found.is_null()     ? "null"
                     : found.is_bool()   ? "a truth value"
                     : found.is_number() ? "a number"
                     : found.is_string() ? "a text"
                     : found.is_array()  ? "a list"
                                         : "an object";
  throw JsonError(std::string("expected ") + expected + ", found " + what);
}

/// The message of the library, without its own name and number.
std::string reason(std::string_view said) {
  const std::size_t end = said.starts_with('[') ? said.find("] ") : said.npos;
  return std::string(end == said.npos ? said : said.substr(end + 2));
}

}  // namespace

/// Members are added at the end of `made`; `by_key` points to them in the order of their keys.
struct Json::Object {
  std::vector<std::unique_ptr<Member>> made;
  std::vector<Member*> by_key;

  std::vector<Member*>::const_iterator place_of(std::string_view key) const noexcept {
    if (by_key.empty() || by_key.back()->first < key) return by_key.end();
    return std::lower_bound(by_key.begin(), by_key.end(), key,
                            [](const Member* member, std::string_view wanted) { return member->first < wanted; });
  }

  Json& member(std::string_view key) {
    const auto place = place_of(key);
    if (place != by_key.end() && (*place)->first == key) return (*place)->second;
    made.push_back(std::make_unique<Member>(key, Json()));
    return (*by_key.insert(place, made.back().get()))->second;
  }
};

Json::Json(unsigned long long value) noexcept : JsonKind(value > INT64_MAX ? Kind::kUint64 : Kind::kInt64) {
  value_.uint64 = value;
}

Json::Json(std::string text) : JsonKind(Kind::kString) { value_.text = new std::string(std::move(text)); }

Json::Json(std::vector<Json> elements) : JsonKind(Kind::kArray) {
  value_.elements = new std::vector<Json>(std::move(elements));
}

Json::Json(const std::vector<std::string>& texts) : Json(std::vector<Json>(texts.begin(), texts.end())) {}

Json::Json(std::initializer_list<Json> items) : Json() {
  const bool is_object = std::all_of(items.begin(), items.end(), [](const Json& item) {
    return item.is_array() && item.size() == 2 && item[0].is_string();
  });
  *this = is_object ? object() : array(items);
  if (!is_object) return;
  for (const Json& item : items) (*this)[item[0].as_string()] = std::move(item.value_.elements->back());
}

Json::Json(const Json& other) : JsonKind(other.kind_), value_(other.value_) {
  if (is_string()) value_.text = new std::string(*other.value_.text);
  if (is_array()) value_.elements = new std::vector<Json>(*other.value_.elements);
  if (!is_object()) return;
  value_.object = new Object;
  for (const auto& member : other.value_.object->made) value_.object->member(member->first) = member->second;
}

Json::Json(Json&& other) noexcept : JsonKind(std::exchange(other.kind_, Kind::kNull)), value_(other.value_) {}

Json& Json::operator=(Json other) noexcept {
  std::swap(kind_, other.kind_);
  std::swap(value_, other.value_);
  return *this;
}

Json::~Json() {
  if (is_string()) delete value_.text;
  if (is_array()) delete value_.elements;
  if (is_object()) delete value_.object;
}

Json Json::array(std::initializer_list<Json> elements) {
  std::vector<Json> made;
  made.reserve(elements.size());
  for (const Json& element : elements) made.push_back(std::move(const_cast<Json&>(element)));  // its parts are mutable
  return made;
}

Json Json::object() {
  Json made;
  made.value_.object = new Object;
  made.kind_ = Kind::kObject;
  return made;
}

bool Json::as_bool() const { return is_bool() ? value_.truth : (refuse("true or false", *this), false); }

std::int64_t Json::as_int64() const {
  constexpr double kBeyond = 9223372036854775808.0;
  if (kind_ == Kind::kInt64) return value_.int64;
  if (kind_ == Kind::kUint64) return INT64_MAX;
  if (kind_ != Kind::kDouble) refuse("a number", *this);
  if (!(value_.number >= -kBeyond)) return INT64_MIN;
  return value_.number < kBeyond ? static_cast<std::int64_t>(value_.number) : INT64_MAX;
}

std::uint64_t Json::as_uint64() const {
  constexpr double kBeyond = 18446744073709551616.0;
  if (kind_ == Kind::kUint64) return value_.uint64;
  if (kind_ == Kind::kDouble && value_.number >= 1)
    return value_.number < kBeyond ? static_cast<std::uint64_t>(value_.number) : UINT64_MAX;
  return static_cast<std::uint64_t>(std::max<std::int64_t>(as_int64(), 0));
}

double Json::as_double() const {
  if (kind_ == Kind::kInt64) return static_cast<double>(value_.int64);
  if (kind_ == Kind::kUint64) return static_cast<double>(value_.uint64);
  return is_number() ? value_.number : (refuse("a number", *this), 0);
}

const std::string& Json::as_string() const {
  if (!is_string()) refuse("a text", *this);
  return *value_.text;
}

std::vector<std::string> Json::as_strings() const {
  if (!is_array()) refuse("a list of texts", *this);
  std::vector<std::string> texts;
  for (const Json& element : *this) texts.push_back(element.as_string());
  return texts;
}

std::size_t Json::size() const noexcept {
  return is_array() ? value_.elements->size() : is_object() ? value_.object->made.size() : 0;
}

const Json* Json::find(std::string_view key) const noexcept {
  if (!is_object()) return nullptr;
  const auto place = value_.object->place_of(key);
  return place != value_.object->by_key.end() && (*place)->first == key ? &(*place)->second : nullptr;
}

const Json& Json::operator[](std::string_view key) const noexcept {
  const Json* found = find(key);
  return found == nullptr ? null_json() : *found;
}

const Json& Json::operator[](std::size_t i) const noexcept {
  return is_array() && i < size() ? (*value_.elements)[i] : null_json();
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) *this = object();
  if (!is_object()) refuse("an object", *this);
  return value_.object->member(key);
}

Json& Json::operator[](std::size_t i) {
  if (!is_array() || i >= size()) refuse("a longer list", *this);
  return (*value_.elements)[i];
}

const Json& Json::at(std::string_view key) const {
  const Json* found = find(key);
  if (found == nullptr) throw JsonError("the key '" + std::string(key) + "' is missing");
  return *found;
}

const Json* Json::begin() const noexcept { return is_array() ? value_.elements->data() : nullptr; }

std::vector<Json>& Json::elements() {
  if (!is_array()) refuse("a list", *this);
  return *value_.elements;
}

void Json::push_back(Json element) {
  if (is_null()) *this = array();
  elements().push_back(std::move(element));
}

Json::Members Json::items() const noexcept {
  return {is_object() ? value_.object->by_key.data() : nullptr, is_object() ? size() : 0};
}

bool operator==(const Json& a, const Json& b) noexcept {
  using Kind = Json::Kind;
  if (a.kind_ != b.kind_)
    return (a.kind_ == Kind::kDouble || b.kind_ == Kind::kDouble) && a.is_number() && b.is_number() &&
           a.as_double() == b.as_double();
  switch (a.kind_) {
    case Kind::kNull:
      return true;
    case Kind::kBool:
      return a.value_.truth == b.value_.truth;
    case Kind::kInt64:
      return a.value_.int64 == b.value_.int64;
    case Kind::kUint64:
      return a.value_.uint64 == b.value_.uint64;
    case Kind::kDouble:
      return a.value_.number == b.value_.number;
    case Kind::kString:
      return *a.value_.text == *b.value_.text;
    case Kind::kArray:
      return *a.value_.elements == *b.value_.elements;
    case Kind::kObject:
      return std::ranges::equal(a.value_.object->by_key, b.value_.object->by_key,
                                [](const auto* one, const auto* other) { return *one == *other; });
  }
  return false;
}

std::ostream& operator<<(std::ostream& out, const Json& json) { return out << json.dump(); }

/// The library calls a function for each value that it finds in a text; a function that returns false ends this.
class Json::Parser {
 public:
  explicit Parser(std::optional<std::string>* twice) : twice_(twice) {}

  bool null() { return put(nullptr) != nullptr; }
  bool boolean(bool value) { return put(value) != nullptr; }
  bool number_integer(std::int64_t value) { return put(value) != nullptr; }
  bool number_unsigned(std::uint64_t value) { return put(value) != nullptr; }
  bool number_float(double value, const std::string&) { return put(value) != nullptr; }
  bool string(std::string& value) { return put(std::move(value)) != nullptr; }
  bool binary(const nlohmann::json::binary_t&) { return false; }  // of other formats
  bool start_object(std::size_t) { return open(object()); }
  bool start_array(std::size_t) { return open(array()); }
  bool end_object() { return open_.pop_back(), true; }
  bool end_array() { return open_.pop_back(), true; }
  bool key(const std::string& key) {
    const std::size_t before = open_.back()->size();
    member_ = &(*open_.back())[key];
    if (open_.back()->size() == before && twice_ != nullptr && !*twice_) *twice_ = key;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const std::exception& why) {
    return error = reason(why.what()), false;
  }

  Json tree;
  std::string error;

 private:
  Json* put(Json value) {
    if (!open_.empty() && open_.back()->is_array()) {
      open_.back()->push_back(std::move(value));
      return &open_.back()->elements().back();
    }
    Json* place = open_.empty() ? &tree : member_;
    *place = std::move(value);
    return place;
  }

  bool open(Json container) {
    if (open_.size() >= kMostNesting) return error = "nested deeper than " + std::to_string(kMostNesting), false;
    open_.push_back(put(std::move(container)));
    return true;
  }

  std::optional<std::string>* twice_;
  std::vector<Json*> open_;  // around the place
  Json* member_ = nullptr;   // whose value is next
};

Json Json::parse(std::string_view text, std::optional<std::string>* twice) {
  Parser parser(twice);
  if (!nlohmann::json::sax_parse(text.begin(), text.end(), &parser)) throw JsonError(parser.error);
  return std::move(parser.tree);
}

std::optional<Json> Json::parse_or_none(std::string_view text, std::optional<std::string>* twice) {
  Parser parser(twice);
  if (!nlohmann::json::sax_parse(text.begin(), text.end(), &parser)) return std::nullopt;
  return std::move(parser.tree);
}

class Json::Writer {
 public:
  explicit Writer(Style style) : style_(style) {}

  void write(const Json& json, std::size_t level) {
    switch (json.kind_) {
      case Kind::kNull:
        text += "null";
        break;
      case Kind::kBool:
        text += json.value_.truth ? "true" : "false";
        break;
      case Kind::kInt64:
        text += std::to_string(json.value_.int64);
        break;
      case Kind::kUint64:
        text += std::to_string(json.value_.uint64);
        break;
      case Kind::kDouble:
        write(json.value_.number);
        break;
      case Kind::kString:
        write(*json.value_.text);
        break;
      case Kind::kArray:
        write(*json.value_.elements, level);
        break;
      case Kind::kObject:
        write(*json.value_.object, level);
        break;
    }
  }

  std::string text;

 private:
  void write(double number) {
    char digits[64];
    if (!std::isfinite(number))
      text += "null";
    else
      text.append(digits, nlohmann::detail::to_chars(digits, digits + sizeof digits, number));
  }

  void write(const std::string& string) {
    const auto is_plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
    if (std::all_of(string.begin(), string.end(), is_plain))
      text.append(1, '"').append(string).append(1, '"');
    else
      text += nlohmann::json(string).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  void write(const std::vector<Json>& elements, std::size_t level) {
    text += '[';
    for (const Json& element : elements) {
      begin_item(&element == elements.data(), level + 1);
      write(element, level + 1);
    }
    if (!elements.empty()) end_line(level);
    text += ']';
  }

  void write(const Object& object, std::size_t level) {
    text += '{';
    for (std::size_t i = 0; i < object.made.size(); ++i) {
      const Member& member = style_ == Style::kDense ? *object.by_key[i] : *object.made[i];
      begin_item(i == 0, level + 1);
      write(member.first);
      text += is_dense() ? ":" : ": ";
      write(member.second, level + 1);
    }
    if (!object.made.empty()) end_line(level);
    text += '}';
  }

  bool is_dense() const { return style_ == Style::kDense || style_ == Style::kAsMade; }

  void begin_item(bool is_first, std::size_t level) {
    if (!is_first) text += style_ == Style::kSpaced ? ", " : ",";
    end_line(level);
  }

  void end_line(std::size_t next_level) {
    if (style_ == Style::kLines) text.append(1, '\n').append(2 * next_level, ' ');
  }

  Style style_;
};

std::string Json::dump(Style style) const {
  Writer writer(style);
  writer.write(*this, 0);
  return std::move(writer.text);
}

std::string text_at(const Json& object, std::string_view key, const char* otherwise) {
  const Json& found = object[key];
  return found.is_string() ? found.as_string() : otherwise;
}

std::int64_t whole_at(const Json& object, std::string_view key, std::int64_t otherwise) {
  const Json& found = object[key];
  return found.is_whole() ? found.as_int64() : otherwise;
}

bool truth_at(const Json& object, std::string_view key, bool otherwise) {
  const Json& found = object[key];
  return found.is_bool() ? found.as_bool() : otherwise;
}

}  // namespace chimera
