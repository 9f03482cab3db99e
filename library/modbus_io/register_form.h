// SPDX-License-Identifier: Apache-2.0
// How numbers lie in registers: one or two registers, whole or floating, either word first.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/math.h"

namespace chimera::library {

enum class RegisterForm : std::uint8_t { kInt16, kUint16, kInt32, kUint32, kFloat32 };

/// One number in the registers of a device.
struct RegisterPlace {
  bool is_holding = false;  ///< false: an input register
  int address = 0;
  RegisterForm form = RegisterForm::kInt16;
  bool is_low_first = false;  ///< the register with the low word has the lower address

  /// Registers of the number. Context: any; wait-free.
  std::size_t width() const noexcept { return form <= RegisterForm::kUint16 ? 1 : 2; }

  /// The number in width() registers; a float32 may be not finite. Context: cycle; wait-free.
  double number(const std::uint16_t* words) const noexcept {
    if (form == RegisterForm::kInt16) return static_cast<std::int16_t>(words[0]);
    if (form == RegisterForm::kUint16) return words[0];
    const std::uint32_t high = words[is_low_first ? 1 : 0], low = words[is_low_first ? 0 : 1], both = high << 16 | low;
    if (form == RegisterForm::kInt32) return static_cast<std::int32_t>(both);
    return form == RegisterForm::kUint32 ? static_cast<double>(both) : static_cast<double>(std::bit_cast<float>(both));
  }
  /// Writes a finite number, cut at the limits of the form; whole numbers are rounded. Context: cycle; wait-free.
  void put(double number, std::uint16_t* words) const noexcept {
    constexpr double kLow[] = {-32768, 0, -2147483648.0, 0, -3.4028234663852886e38};
    constexpr double kHigh[] = {32767, 65535, 2147483647.0, 4294967295.0, 3.4028234663852886e38};
    const auto f = static_cast<std::size_t>(form);
    const double near = form == RegisterForm::kFloat32 ? number : math::floor(number + 0.5);
    const double held = near < kLow[f] ? kLow[f] : near > kHigh[f] ? kHigh[f] : near;
    const std::uint32_t both = form == RegisterForm::kFloat32
                                   ? std::bit_cast<std::uint32_t>(static_cast<float>(held))
                                   : static_cast<std::uint32_t>(static_cast<std::int64_t>(held));
    words[is_low_first || width() == 1 ? 0 : 1] = static_cast<std::uint16_t>(both);
    if (width() == 2) words[is_low_first ? 1 : 0] = static_cast<std::uint16_t>(both >> 16);
  }
};

/// Reads "int16" or "float32_low" into `to`; false if `word` is no form. Context: setup.
inline bool read_form(std::string_view word, RegisterPlace& to) {
  constexpr std::string_view kForms[] = {"int16", "uint16", "int32", "uint32", "float32"};
  const bool is_low_first = word.ends_with("_low");
  const auto found = std::ranges::find(kForms, word.substr(0, word.size() - (is_low_first ? 4 : 0)));
  if (found == std::end(kForms)) return false;
  to.form = static_cast<RegisterForm>(found - std::begin(kForms));
  to.is_low_first = is_low_first;
  return !is_low_first || to.width() == 2;
}

/// Reads the places of `count` numbers: "holding:100 int16 float32 input:7 uint32_low". A word with a colon says where
/// the next number is; each further number follows the one before. The last form is that of the numbers behind it.
/// Throws std::runtime_error, with `name`, the constant. Context: setup.
inline std::vector<RegisterPlace> register_places(std::string_view text, const char* name, std::size_t count,
                                                  bool is_written) {
  const auto refuse = [&](const std::string& why) -> void {
    throw std::runtime_error("`" + std::string(name) + "`: " + why);
  };
  std::vector<RegisterPlace> places;
  RegisterPlace next{.is_holding = is_written};
  int end = 0;  // behind the number before
  const auto add = [&] {
    next.address = end;
    end += static_cast<int>(next.width());
    places.push_back(next);
    if (end > 65536) refuse("the last register is 65535");
  };
  for (std::size_t at = 0; (at = text.find_first_not_of(' ', at)) != std::string_view::npos;) {
    const std::string_view word = text.substr(at, text.find(' ', at) - at);
    at += word.size();
    const std::size_t colon = word.find(':');
    if (colon != std::string_view::npos) {
      const std::string_view kind = word.substr(0, colon), digits = word.substr(colon + 1);
      const bool is_place = (kind == "holding" || (kind == "input" && !is_written)) && !digits.empty() &&
                            digits.size() <= 5 && digits.find_first_not_of("0123456789") == std::string_view::npos;
      if (!is_place)
        refuse("\"" + std::string(word) + "\" is no place: holding:100 is one" +
               (is_written ? "" : ", input:100 another"));
      next.is_holding = kind == "holding";
      end = std::stoi(std::string(digits));
      continue;
    }
    if (!read_form(word, next))
      refuse("\"" + std::string(word) + "\" is no form: int16 uint16 int32 uint32 float32, and int32_low uint32_low "
             "float32_low with the low word first");
    add();
  }
  if (places.size() > count && count > 0)
    refuse("has " + std::to_string(places.size()) + " forms, and there are " + std::to_string(count) + " ports");
  while (places.size() < count) add();
  places.resize(count);
  return places;
}

}  // namespace chimera::library
