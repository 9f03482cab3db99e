// SPDX-License-Identifier: Apache-2.0
// Makes the secret of a link and compares it with what a browser sends.
#include "chimera/web/page_key.h"

#include <cstddef>
#include <cstdint>

#include "chimera/platform/descriptor.h"
#include "chimera/platform/random.h"

namespace chimera::web {

Result<PageKey> PageKey::make() {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::byte bits[32];
  if (!fill_random(bits)) return system_error(Message("the key of the page"), "getrandom");
  std::string text;
  std::uint32_t held = 0;
  int n_held = 0;
  for (const std::byte byte : bits) {
    held = held << 8 | std::to_integer<std::uint32_t>(byte);
    for (n_held += 8; n_held >= 6; n_held -= 6) text += kDigits[held >> (n_held - 6) & 63u];
  }
  text += kDigits[held << (6 - n_held) & 63u];
  return PageKey(std::move(text));
}

bool PageKey::is(std::string_view given) const noexcept {
  volatile unsigned difference = given.size() != text_.size();
  for (std::size_t i = 0; i < text_.size(); ++i) {
    const char one = i < given.size() ? given[i] : '\0';
    difference = difference | (static_cast<unsigned char>(one) ^ static_cast<unsigned char>(text_[i]));
  }
  return difference == 0;
}

}  // namespace chimera::web
