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

// One call of a function where each == would be code of its own.
[[gnu::noinline]] bool is_one_of(std::string_view word, const char* a, const char* b) noexcept {
  return word == a || word == b;
}

bool begins_number(std::string_view word) noexcept {
  if (word.starts_with('-')) word.remove_prefix(1);
  return !word.empty() && ((word[0] >= '0' && word[0] <= '9') || word[0] == '.');
}

bool is_value(std::uint32_t type, std::string_view word) noexcept {
  return begins_number(word) || (type == CHIMERA_BOOL && is_one_of(word, "true", "false"));
}

/// A whole number, at most 19 digits; none: the word is none, or does not fit.
std::optional<std::int64_t> whole(std::string_view word, std::uint64_t most) noexcept {
  const bool is_negative = word.starts_with('-');
  if (is_negative) word.remove_prefix(1);
  if (word.empty() || word.size() > 19) return std::nullopt;
  std::uint64_t value = 0;
  for (const char c : word) {
    if (c < '0' || c > '9') return std::nullopt;
    value = value * 10 + static_cast<std::uint64_t>(c - '0');
  }
  if (value > most + (is_negative ? 1 : 0)) return std::nullopt;
  return static_cast<std::int64_t>(is_negative ? 0 - value : value);
}

bool read_whole(std::uint32_t type, std::string_view word, std::byte* to) noexcept {
  if (type == CHIMERA_BOOL) {
    const bool is_true = is_one_of(word, "true", "1");
    store(to, static_cast<std::uint8_t>(is_true ? 1 : 0));
    return is_true || is_one_of(word, "false", "0");
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

constexpr const char* kTypeNames[] = {"bool: true, false, 1 or 0", "int32", "int64", "float32", "float64"};
static_assert(CHIMERA_BOOL == 0 && CHIMERA_INT32 == 1 && CHIMERA_INT64 == 2 && CHIMERA_FLOAT32 == 3 &&
              CHIMERA_FLOAT64 == 4);

}  // namespace

bool TypedValue::begin_text(TextLine& why) noexcept {
  if (shape_.count != 1 || shape_.element_bytes > kMostValueBytes) {
    why.put("%s does not fit in a line", shape_.name);
    return false;
  }
  if (text_.size() >= shape_.element_bytes) {
    why.put("%s takes a text of %u bytes, not %u", shape_.name, shape_.element_bytes - 1, text_.size());
    return false;
  }
  std::memset(to_.data(), 0, shape_.element_bytes);
  std::memcpy(to_.data(), text_.data(), text_.size());
  return true;
}

bool TypedValue::begin(TextLine& why) noexcept {
  if (shape_.type == CHIMERA_STRING) return begin_text(why);
  if (shape_.type > CHIMERA_FLOAT64) {
    why.put("%s is a struct", shape_.name);
    return false;
  }
  n_words_ = words_.size();
  if (n_words_ > 0 && !is_value(shape_.type, words_[n_words_ - 1])) {
    const std::string_view unit = words_[--n_words_];
    if (unit != shape_.unit) {
      if (shape_.unit == "1") why.put("%s has no unit, and '%s' is no number", shape_.name, unit);
      else why.put("%s is in %s, not in '%s'", shape_.name, shape_.unit, unit);
      return false;
    }
  }
  if (n_words_ != shape_.count) {
    why.put("%s has %u element%z, not %u", shape_.name, shape_.count, shape_.count == 1 ? "" : "s", n_words_);
    return false;
  }
  if (std::size_t{shape_.count} * shape_.element_bytes <= kMostValueBytes) return true;
  why.put("%s does not fit in a line", shape_.name);
  return false;
}

bool TypedValue::read_next(TextLine& why) noexcept {
  const std::string_view word = words_[n_read_];
  std::byte* const to = to_.data() + n_read_ * shape_.element_bytes;
  ++n_read_;
  const bool is_floating = shape_.type == CHIMERA_FLOAT32 || shape_.type == CHIMERA_FLOAT64;
  if (is_floating ? read_floating(shape_.type, word, to) : read_whole(shape_.type, word, to)) return true;
  why.put("'%s' is no %z", word, kTypeNames[shape_.type]);
  return false;
}

}  // namespace chimera::firmware
