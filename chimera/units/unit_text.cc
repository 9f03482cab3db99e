// SPDX-License-Identifier: Apache-2.0
// Parses the text of a unit into words and powers.
#include "chimera/units/unit_text.h"

#include <cstdlib>

#include "chimera/text/decimal.h"

namespace chimera {
namespace {

bool is_word(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '%'; }

/// Replaces signs that people type by their ASCII spelling: micro, ohm, degree, product dots, raised digits, spaces.
std::string plain(std::string_view text) {
  struct Spelling {
    std::string_view sign, ascii;
  };
  constexpr Spelling kSpellings[] = {
      {"\xc2\xb5", "u"},     {"\xce\xbc", "u"},         {"\xc2\xb0", "deg"},       {"\xc2\xb7", "."},
      {"\xe2\x8b\x85", "."}, {"\xe2\x84\xa6", "ohm"}, {"\xce\xa9", "ohm"},       {"\xc2\xb9", "1"},
      {"\xc2\xb2", "2"},     {"\xc2\xb3", "3"},         {"\xe2\x81\xbb", "-"},    {kSpaces[1], " "},
      {kSpaces[2], " "},       {kSpaces[3], " "}};
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t used = 0;
    for (const Spelling& s : kSpellings) {
      if (text.substr(i).starts_with(s.sign)) out += s.ascii, used = s.sign.size();
    }
    if (used == 0) out += text[i], used = 1;
    i += used;
  }
  return out;
}

bool is_bounded(const UnitExpression& expression, int limit) {
  for (const int e : expression.rest.exponents) {
    if (std::abs(e) > limit) return false;
  }
  for (const int e : expression.variables) {
    if (std::abs(e) > limit) return false;
  }
  return true;
}

/// Recursive descent over one text. The first fault ends it: every function then returns false.
class UnitTextReader {
 public:
  UnitTextReader(std::string_view text, const WordMeaning& meaning,
                 const std::function<std::string(std::string_view)>& unknown)
      : text_(text), meaning_(meaning), unknown_(unknown) {}

  Result<UnitExpression> read() {
    UnitExpression whole;
    if (product(whole, 0) && at_ < text_.size()) expected("a unit, \".\" or \"/\"");
    if (!fault_.empty()) return Error{ErrorCode::kBadInput, std::string_view(fault_), {}};
    return whole;
  }

 private:
  bool fail(std::string why) {
    if (fault_.empty()) fault_ = std::move(why);
    return false;
  }
  bool expected(std::string_view what) {
    std::string found = at_ < text_.size() ? "\"" + text_.substr(at_) + "\"" : std::string("the end");
    return fail("unit \"" + text_ + "\": expected " + std::string(what) + ", found " + found);
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  bool product(UnitExpression& whole, int depth) {
    if (!factor(whole, depth)) return false;
    bool divided = false;
    for (char c = peek(); c == '.' || c == '*' || c == ' ' || c == '/'; c = peek()) {
      if (c != '/' && divided) {
        return fail("unit \"" + text_ + "\": a product after \"/\" can be read in two ways; write a/(b.c) or a.c/b");
      }
      ++at_;
      UnitExpression next;
      if (!factor(next, depth)) return false;
      whole = c == '/' ? whole / next : whole * next;
      divided = divided || c == '/';
      if (!is_bounded(whole, kMaxUnitExponent)) return fail("unit \"" + text_ + "\": an exponent above 30");
    }
    return true;
  }

  bool factor(UnitExpression& out, int depth) {
    if (peek() == '(') {
      if (depth == 8) return fail("unit \"" + text_ + "\": more than 8 parentheses in each other");
      ++at_;
      if (!product(out, depth + 1)) return false;
      if (peek() != ')') return expected("\")\"");
      ++at_;
      return exponent(out);
    }
    if (is_digit(peek())) return one(out);
    return word(out) && exponent(out);
  }

  bool one(UnitExpression& out) {
    const std::size_t begin = at_;
    while (is_digit(peek())) ++at_;
    if (text_.substr(begin, at_ - begin) != "1") {
      at_ = begin;
      return expected("a unit; 1 is the only number in one");
    }
    out = UnitExpression{};
    return true;
  }

  bool word(UnitExpression& out) {
    const std::size_t begin = at_;
    while (is_word(peek())) ++at_;
    const std::string name = text_.substr(begin, at_ - begin);
    if (name.empty()) return expected("a unit");
    const auto found = meaning_(name);
    if (!found) return fail(unknown_(name));
    out = *found;
    return true;
  }

  bool exponent(UnitExpression& out) {
    const std::size_t begin = at_;
    if (peek() == '^') ++at_;
    const bool negative = peek() == '-';
    if (negative) ++at_;
    const std::size_t digits = at_;
    while (is_digit(peek())) ++at_;
    if (at_ == begin) return true;
    if (at_ == digits) return expected("an exponent");
    if (at_ - digits > 2) return fail("unit \"" + text_ + "\": an exponent above 30");
    const int n = std::atoi(text_.substr(digits, at_ - digits).c_str());
    if (n == 0 || n > kMaxUnitExponent) {
      return fail("unit \"" + text_ + "\": an exponent is from 1 to 30, positive or negative");
    }
    out = power(out, negative ? -n : n);
    return is_bounded(out, kMaxUnitExponent) || fail("unit \"" + text_ + "\": an exponent above 30");
  }

  std::string text_;
  const WordMeaning& meaning_;
  const std::function<std::string(std::string_view)>& unknown_;
  std::size_t at_ = 0;
  std::string fault_;
};

}  // namespace

Result<UnitExpression> read_unit_text(std::string_view text, const WordMeaning& meaning,
                                      const std::function<std::string(std::string_view word)>& unknown) {
  if (text.empty()) return Error{ErrorCode::kBadInput, std::string_view("the unit is empty; write 1 for none"), {}};
  if (text.size() > kMaxUnitText) {
    return Error{ErrorCode::kBadInput, std::string_view("a unit text of more than 100 bytes"), {}};
  }
  return UnitTextReader(plain(text), meaning, unknown).read();
}

}  // namespace chimera
