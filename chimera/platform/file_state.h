// SPDX-License-Identifier: Apache-2.0
// What tells whether a file is still the one that was read, and its replacement where it is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "chimera/base/result.h"

namespace chimera {

struct FileState {
  std::uint64_t inode = 0;
  unsigned mode = 0;            ///< permissions
  std::int64_t changed_ns = 0;  ///< since 1970
  bool operator==(const FileState&) const noexcept = default;
};

/// None when there is no such file. Context: setup; may block.
std::optional<FileState> state_of_file(const std::string& path);

/// Puts a new file with `text` and the permissions of `known` in the place of the file at `path`, whole or not at all.
/// Refuses, with the path in `where`, what cannot be written, and a file that is not in the state `known`.
/// Context: setup; may block.
Result<void> replace_file(const std::string& path, const FileState& known, std::string_view text);

/// Makes a folder that only this user may look into; true when it is there. Context: setup; may block.
bool make_private_folder(const std::string& path);

/// CLOCK_REALTIME minus CLOCK_MONOTONIC, in ns. Context: setup.
std::int64_t wall_clock_shift() noexcept;

}  // namespace chimera
