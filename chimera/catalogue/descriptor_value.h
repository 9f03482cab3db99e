// SPDX-License-Identifier: Apache-2.0
// Converts the bytes of an initial value to numbers and texts, and back, for descriptor files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

namespace chimera {

/// One plain value. Infinite numbers are doubles here and the words "inf" and "-inf" in files.
using PlainValue = std::variant<bool, std::int64_t, double, std::string>;

/// The value of type `type` (CHIMERA_BOOL to CHIMERA_STRING, or CHIMERA_ANY as int64) at `at`. Context: setup.
PlainValue load_plain(std::uint32_t type, std::span<const std::byte> at);

/// Writes `value` to `at`, filled with zeros. False if it does not fit the type: a fraction for an int32, a text that
/// is too long, a number for a bool. A whole number fits a floating type. Context: setup.
bool store_plain(std::uint32_t type, const PlainValue& value, std::span<std::byte> at);

}  // namespace chimera
