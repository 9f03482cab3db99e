// SPDX-License-Identifier: Apache-2.0
// NAME.component.json <-> Descriptor (docs/formats/descriptor.md). The build writes these files; people read them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/load/descriptor.h"

namespace chimera {

inline constexpr std::size_t kMaxDescriptorBytes = 256 * 1024;
inline constexpr std::size_t kMaxDescriptorNesting = 32;

/// Parses `text` and calls complete(). Strict: refuses an unknown, missing or repeated key, a value of a wrong type,
/// and text above the limits. Also refuses all that describe() would refuse. The message has the JSON path of the
/// place. Context: setup; bounded time and memory.
Result<Descriptor> parse_descriptor(std::string_view text);

/// The text of the file: two spaces of indentation, a fixed order of keys, an end of line. parse_descriptor() returns
/// an equal descriptor, to the last bit of every number. Context: setup.
std::string to_json(const Descriptor& descriptor);

/// Reads and parses the file; Error::where is the path. Context: setup; may block.
Result<Descriptor> read_descriptor_file(const std::string& path);

}  // namespace chimera
