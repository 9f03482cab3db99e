// SPDX-License-Identifier: Apache-2.0
// YAML 1.2 text -> Node, with limits that hold before the parser sees a byte (docs/formats/description.md,
// "Limits of the text"). The only user of yaml-cpp.
#pragma once

#include <optional>
#include <string_view>

#include "chimera/description/node.h"
#include "chimera/description/report.h"

namespace chimera {

inline constexpr std::size_t kMaxTextBytes = 256 * 1024;
inline constexpr std::size_t kMaxNesting = 32;
inline constexpr std::size_t kMaxEntries = 32768;
inline constexpr std::size_t kMaxValueBytes = 1024;

/// The tree of the only document in `text`. Adds breaches to `report`; nullopt if no tree can be built. A tree may come
/// with faults (a repeated key): continue, so that one report has all of them. Time and memory are bounded by the
/// limits above. Context: setup.
std::optional<Node> read_yaml(std::string_view text, Report& report);

}  // namespace chimera
