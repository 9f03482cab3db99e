// SPDX-License-Identifier: Apache-2.0
// Converts the bytes of a value of each type to JSON and back.
#include "chimera/catalogue/descriptor_value.h"

#include <cstring>
#include <optional>

#include "chimera/task/abi.h"

namespace chimera {
namespace {

template <class T>
T read(std::span<const std::byte> at) {
  T value{};
  std::memcpy(&value, at.data(), sizeof value);
  return value;
}

template <class T>
bool write(std::span<std::byte> at, T value) {
  std::memcpy(at.data(), &value, sizeof value);
  return true;
}

std::optional<double> number(const PlainValue& value) {
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  return std::nullopt;
}

bool store_text(const PlainValue& value, std::span<std::byte> at) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr || text->size() >= at.size() || text->find('\0') != std::string::npos) return false;
  std::memset(at.data(), 0, at.size());
  std::memcpy(at.data(), text->data(), text->size());
  return true;
}

}  // namespace

PlainValue load_plain(std::uint32_t type, std::span<const std::byte> at) {
  switch (type) {
    case CHIMERA_BOOL:
      return at[0] != std::byte{0};
    case CHIMERA_INT32:
      return std::int64_t{read<std::int32_t>(at)};
    case CHIMERA_FLOAT32:
      return static_cast<double>(read<float>(at));
    case CHIMERA_FLOAT64:
      return read<double>(at);
    case CHIMERA_STRING: {
      const char* text = reinterpret_cast<const char*>(at.data());
      return std::string(text, ::strnlen(text, at.size()));
    }
    default:
      return read<std::int64_t>(at);
  }
}

bool store_plain(std::uint32_t type, const PlainValue& value, std::span<std::byte> at) {
  if (type == CHIMERA_STRING) return store_text(value, at);
  if (type == CHIMERA_BOOL) {
    const auto* truth = std::get_if<bool>(&value);
    return truth != nullptr && write(at, static_cast<std::uint8_t>(*truth ? 1 : 0));
  }
  if (type == CHIMERA_FLOAT32 || type == CHIMERA_FLOAT64) {
    const auto real = number(value);
    if (!real) return false;
    return type == CHIMERA_FLOAT64 ? write(at, *real) : write(at, static_cast<float>(*real));
  }
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (whole == nullptr) return false;
  if (type != CHIMERA_INT32) return write(at, *whole);
  return *whole >= INT32_MIN && *whole <= INT32_MAX && write(at, static_cast<std::int32_t>(*whole));
}

}  // namespace chimera
