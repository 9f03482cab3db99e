// SPDX-License-Identifier: Apache-2.0
// Values that stand in target files only: addresses, words of 32 bits, ranges of memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "chimera/bake/target.h"
#include "chimera/description/node.h"
#include "chimera/description/report.h"

namespace chimera::bake {

/// Each function adds one fault to `report` and returns nullopt for another value. Context: setup.
/// A number below 2^32, decimal or as 0x1f.
std::optional<std::uint32_t> read_word(const Node& node, const std::string& what, Report& report);
/// A number as read_word() reads it that is a multiple of 4.
std::optional<std::uint32_t> read_address(const Node& node, const std::string& what, Report& report);
/// {address: ..., size: ...}
std::optional<MemoryRange> read_memory(const Node& node, const std::string& what, Report& report);
/// The item under `key`; adds a fault if `map` does not have it.
const Node* required(const Node& map, const char* key, const std::string& what, const char* remedy, Report& report);

}  // namespace chimera::bake
