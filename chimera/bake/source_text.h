// SPDX-License-Identifier: Apache-2.0
// Constants of C++ as text: literals, designated initialisers, arrays.
#pragma once

#include <concepts>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"

namespace chimera::bake {

/// Each function gives a constant expression of its value. Context: setup.
std::string literal(std::string_view text);  ///< "a\"b"
std::string literal(double value);           ///< the shortest text with the same value; an infinity as a builtin
std::string literal(Nanoseconds time);       ///< {1000000}
std::string literal(bool value);
template <std::unsigned_integral Number>
  requires(!std::same_as<Number, bool>)
std::string literal(Number value) {
  return std::to_string(value);
}
template <class Tag>
std::string literal(const char* type, Id<Tag> id) {
  return std::string(type) + "(" + std::to_string(id.index) + "u)";
}

/// "{.name = "pid", .period = {1000000}}". A value equal to the default of its member is left out.
class Initialiser {
 public:
  template <class Value>
  Initialiser& add(const char* member, const Value& value, const Value& otherwise) {
    return value == otherwise ? *this : add_text(member, literal(value));
  }
  template <class Tag>
  Initialiser& add_id(const char* member, const char* type, Id<Tag> id) {
    return id.is_valid() ? add_text(member, literal(type, id)) : *this;
  }
  /// Nothing if `text` is empty.
  Initialiser& add_text(const char* member, const std::string& text);
  std::string text() const { return "{" + all_ + "}"; }

 private:
  std::string all_;
};

/// The definitions that stand before the tables which name them. Equal arrays of bytes are defined once.
class Definitions {
 public:
  /// Adds `constexpr TYPE NAME[] = {items};` and returns the name; "" without items.
  std::string array(const std::string& type, const std::string& name, std::span<const std::string> items);
  /// As array(), of the texts that `item(element, index)` gives for each element.
  template <class Items, class Item>
  std::string list(const char* type, const char* name, const Items& items, Item item) {
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < items.size(); ++i) texts.push_back(item(items[i], i));
    return array(type, name, texts);
  }
  /// Adds an array of bytes that is aligned for every element type, and returns its name; "" without bytes.
  std::string bytes(std::span<const std::byte> bytes);
  void add(const std::string& line) { text_ += line; }
  const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
  std::map<std::vector<std::byte>, std::string> known_bytes_;
};

}  // namespace chimera::bake
