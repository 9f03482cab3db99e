// SPDX-License-Identifier: Apache-2.0
// Reads the keys of a terminal from its bytes. An arrow key is the three bytes ESC [ A, which may come in two pieces.
#pragma once

#include <cstdint>

namespace chimera::library {

enum class Key : std::uint8_t { kNone, kUp, kDown, kMore, kLess, kEnter, kCancel, kErase, kRepaint, kText };

/// One key. Plain value.
struct Pressed {
  Key key = Key::kNone;
  char text = '\0';  ///< of kText
};

/// Context of everything: cycle; wait-free.
class Keys {
 public:
  /// The key that ends with this byte; kNone if it is the beginning of a key, or no key that is known.
  Pressed take(char byte) noexcept {
    const char before = before_;
    before_ = byte;
    if (part_ == Part::kIntroduced) {
      const bool goes_on = (byte >= '0' && byte <= '9') || byte == ';';
      if (goes_on) return {};
      part_ = Part::kNone;
      return {arrow(byte)};
    }
    if (part_ == Part::kEscape && (byte == '[' || byte == 'O')) {
      part_ = Part::kIntroduced;
      return {};
    }
    const bool was_escape = part_ == Part::kEscape;
    part_ = byte == '\x1b' ? Part::kEscape : Part::kNone;
    if (was_escape) return {Key::kCancel};
    return plain(byte, before);
  }
  /// No byte came for a cycle. A lone ESC was the key of that name.
  Pressed rest() noexcept {
    const bool was_escape = part_ == Part::kEscape;
    part_ = Part::kNone;
    return {was_escape ? Key::kCancel : Key::kNone};
  }

 private:
  enum class Part : std::uint8_t { kNone, kEscape, kIntroduced };

  static Key arrow(char byte) noexcept {
    switch (byte) {
      case 'A': return Key::kUp;
      case 'B': return Key::kDown;
      case 'C': return Key::kMore;
      case 'D': return Key::kLess;
      default: return Key::kNone;
    }
  }
  static Pressed plain(char byte, char before) noexcept {
    switch (byte) {
      case 'k': return {Key::kUp};
      case 'j': case '\t': return {Key::kDown};
      case '+': return {Key::kMore};
      case '\r': return {Key::kEnter};
      case '\n': return {before == '\r' ? Key::kNone : Key::kEnter};
      case 'q': return {Key::kCancel};
      case '\b': case '\x7f': return {Key::kErase};
      case '\f': return {Key::kRepaint};
      default: break;
    }
    return {byte >= ' ' && byte <= '~' ? Key::kText : Key::kNone, byte};
  }

  Part part_ = Part::kNone;
  char before_ = '\0';
};

}  // namespace chimera::library
