// SPDX-License-Identifier: Apache-2.0
// Reads addresses and sizes of a target, with a fault for each kind of mistake.
#include "chimera/bake/target_values.h"

#include <array>
#include <charconv>

#include "chimera/description/draft_values.h"

namespace chimera::bake {
namespace {

constexpr std::uint64_t kAddresses = std::uint64_t{1} << 32;
constexpr std::array<std::string_view, 2> kMemoryKeys = {"address", "size"};

std::optional<std::uint32_t> word_of(std::string_view text) {
  const bool is_hex = text.starts_with("0x");
  if (is_hex) text.remove_prefix(2);
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, is_hex ? 16 : 10);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::uint32_t> read_word(const Node& node, const std::string& what, Report& report) {
  if (node.is_scalar() && !node.quoted)
    if (const auto value = word_of(node.text)) return value;
  report.add({.rule = "number-bad",
              .at = node.at,
              .message = what + " is " + written(node) + "; expected a number from 0 to 0xffffffff",
              .found = node.text,
              .expected = "0 to 0xffffffff",
              .remedy = "write it as 1234 or as 0x4d2"});
  return std::nullopt;
}

std::optional<std::uint32_t> read_address(const Node& node, const std::string& what, Report& report) {
  const auto value = read_word(node, what, report);
  if (!value || *value % 4 == 0) return value;
  report.add({.rule = "number-bad",
              .at = node.at,
              .message = what + " is " + written(node) + "; expected a multiple of 4",
              .found = node.text,
              .expected = "a multiple of 4",
              .remedy = "registers and memories of the core have 32-bit words"});
  return std::nullopt;
}

const Node* required(const Node& map, const char* key, const std::string& what, const char* remedy, Report& report) {
  if (const Node* node = map.find(key)) return node;
  report.add({.rule = "key-missing",
              .at = map.at,
              .message = "the key '" + std::string(key) + "' of " + what + " is missing",
              .expected = key,
              .remedy = remedy});
  return nullptr;
}

std::optional<MemoryRange> read_memory(const Node& node, const std::string& what, Report& report) {
  if (!expect(node, Node::Kind::kMap, what, report)) return std::nullopt;
  refuse_unknown_keys(node, kMemoryKeys, what, report);
  constexpr const char* kForm = "write {address: 0x20000000, size: 20 KiB}";
  const Node* address = required(node, "address", what, kForm, report);
  const Node* size = required(node, "size", what, kForm, report);
  const auto first = address != nullptr ? read_address(*address, "'address' of " + what, report) : std::nullopt;
  const auto bytes =
      size != nullptr ? read_bytes(*size, 1024, kAddresses / 2, "'size' of " + what, report) : std::nullopt;
  if (!first || !bytes) return std::nullopt;
  const std::uint32_t from = first.value_or(0);  // GCC 12 warns of *first
  if (bytes->value % 4 == 0 && from + bytes->value <= kAddresses)
    return MemoryRange{from, static_cast<std::uint32_t>(bytes->value), node.at};
  report.add({.rule = "number-bad",
              .at = node.at,
              .message = what + " has " + std::to_string(bytes->value) + " bytes from " + written(*address) +
                         "; expected a multiple of 4 bytes that ends at 2^32 at the latest",
              .remedy = kForm});
  return std::nullopt;
}

}  // namespace chimera::bake
