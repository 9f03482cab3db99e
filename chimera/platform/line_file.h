// SPDX-License-Identifier: Apache-2.0
// A file of lines that grows at its end and has whole lines only, whoever dies while writing it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// Open to write, and locked against all others that open it so. Movable; closes. Context of all: setup; may block on
/// the disk and for whoever has the lock.
class LineFile {
 public:
  /// Makes the file for this user alone, where there is none, and cuts off what stands behind its last line end:
  /// somebody died there. Refuses, with the path in `where`: "is no ordinary file", "cannot be opened: REASON".
  static Result<LineFile> open(const std::string& path);

  std::uint64_t bytes() const noexcept { return bytes_; }
  /// The last whole lines, of at most `most` bytes together.
  std::string tail(std::size_t most) const;
  /// Puts `lines`, each with its end, behind the others, and waits until the disk has them: all or none. Refuses, with
  /// the path in `where`: "cannot be written: No space left on device".
  Result<void> append(std::string_view lines);
  /// Gives it the name `path`, in the place of whatever has it. Refuses as append(): "cannot be renamed: REASON".
  Result<void> rename_to(const std::string& path);

 private:
  LineFile(std::string path, OwnedDescriptor file, std::uint64_t bytes) noexcept
      : path_(std::move(path)), file_(std::move(file)), bytes_(bytes) {}

  std::string path_;
  OwnedDescriptor file_;
  std::uint64_t bytes_;
};

}  // namespace chimera
