// SPDX-License-Identifier: Apache-2.0
// Reads the elements of a typed value one by one, so that each is a short piece of work.
#include "firmware/shell/typed_value.h"

#include <cstring>
#include <optional>

#include "chimera/base/math.h"
#include "chimera/base/number_text.h"
#include "chimera/task/abi.h"

namespace chimera::firmware {
namespace {

template <class T>
void store(std::byte* to, T value) noexcept {
  std::memcpy(to, &value, sizeof value);
}

bool begins_number(std::string_view word) noexcept {
  if (word.starts_with('-')) word.remove_prefix(1);
  return !word.empty() && ((word[0] >= '0' && word[0] <= '9') || word[0] == '.');
}

bool is_value(std::uint32_t type, std::string_view word) noexcept {
  return begins_number(word) || (type == CHIMERA_BOOL && (word == "true" || word == "false"));
}

/// A whole number of the type; none: the word is none, or does not fit.
std::optional<std::int64_t> whole(std::string_view word, std::uint64_t most) noexcept {
  const bool is_negative = word.starts_with('-');
  if (is_negative) word.remove_prefix(1);
  const std::uint64_t limit = most + (is_negative ? 1 : 0);
  if (word.empty()) return std::nullopt;
  std::uint64_t value = 0;
  for (const char c : word) {
    if (c < '0' || c > '9') return std::nullopt;
    const auto digit = static_cast<std::uint64_t>(c - '0');
    if (value > (limit - digit) / 10) return std::nullopt;
    value = value * 10 + digit;
  }
  return static_cast<std::int64_t>(is_negative ? 0 - value : value);
}

bool read_whole(std::uint32_t type, std::string_view word, std::byte* to) noexcept {
  if (type == CHIMERA_BOOL) {
    const bool is_true = word == "true" || word == "1";
    store(to, static_cast<std::uint8_t>(is_true ? 1 : 0));
    return is_true || word == "false" || word == "0";
  }
  const bool is_short = type == CHIMERA_INT32;
  const auto value = whole(word, is_short ? INT32_MAX : INT64_MAX);
  if (!value) return false;
  if (is_short) store(to, static_cast<std::int32_t>(*value));
  else store(to, *value);
  return true;
}

bool read_floating(std::uint32_t type, std::string_view word, std::byte* to) noexcept {
  const ReadNumber read = read_number(word);
  if (read.length != word.size() || word.empty() || !read.in_range) return false;
  if (type == CHIMERA_FLOAT64) return store(to, read.value), true;
  constexpr double kLargestFloat = 3.4028234663852886e38;
  if (math::fabs(read.value) > kLargestFloat) return false;
  store(to, static_cast<float>(read.value));
  return true;
}

std::string_view wanted(std::uint32_t type) noexcept {
  switch (type) {
    case CHIMERA_BOOL: return "0, 1, true or false";
    case CHIMERA_INT32: return "a whole number of 32 bits";
    case CHIMERA_INT64: return "a whole number of 64 bits";
    case CHIMERA_FLOAT32: return "a number of float32";
    default: return "a number of float64";
  }
}

}  // namespace

bool TypedValue::begin_text(TextLine& why) noexcept {
  if (shape_.count != 1 || shape_.element_bytes > kMostValueBytes) {
    why << shape_.name << " has a shape that cannot be typed";
    return false;
  }
  if (text_.size() >= shape_.element_bytes) {
    why << shape_.name << " takes a text of " << shape_.element_bytes - 1 << " bytes, not " << text_.size();
    return false;
  }
  std::memset(to_.data(), 0, shape_.element_bytes);
  std::memcpy(to_.data(), text_.data(), text_.size());
  return true;
}

bool TypedValue::begin(TextLine& why) noexcept {
  if (shape_.type == CHIMERA_STRING) return begin_text(why);
  if (shape_.type > CHIMERA_FLOAT64) {
    why << shape_.name << " is a struct, which cannot be typed";
    return false;
  }
  n_words_ = words_.size();
  if (n_words_ > 0 && !is_value(shape_.type, words_[n_words_ - 1])) {
    const std::string_view unit = words_[--n_words_];
    if (unit != shape_.unit) {
      why << shape_.name;
      if (shape_.unit == "1") why << " has no unit, and '" << unit << "' is no number";
      else why << " is in " << shape_.unit << ", not in '" << unit << "'";
      return false;
    }
  }
  if (n_words_ != shape_.count) {
    why << shape_.name << " has " << shape_.count << (shape_.count == 1 ? " element" : " elements") << ", not "
        << n_words_;
    return false;
  }
  if (std::size_t{shape_.count} * shape_.element_bytes <= kMostValueBytes) return true;
  why << shape_.name << " has " << shape_.count << " elements, too many for a line";
  return false;
}

bool TypedValue::read_next(TextLine& why) noexcept {
  const std::string_view word = words_[n_read_];
  std::byte* const to = to_.data() + n_read_ * shape_.element_bytes;
  ++n_read_;
  const bool is_floating = shape_.type == CHIMERA_FLOAT32 || shape_.type == CHIMERA_FLOAT64;
  if (is_floating ? read_floating(shape_.type, word, to) : read_whole(shape_.type, word, to)) return true;
  why << "'" << word << "' is not " << wanted(shape_.type);
  return false;
}

}  // namespace chimera::firmware
