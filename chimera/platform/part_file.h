// SPDX-License-Identifier: Apache-2.0
// A file that is written whole or not at all: beside its place first, then put there.
#pragma once

#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// The new file beside its place. Movable; removes it unless it was put there. Context: setup; may block.
class PartFile {
 public:
  /// Refuses, with the path in `where`, a place at which there is something else than an ordinary file ("is no ordinary
  /// file"), and a folder that takes no new file ("cannot be written: REASON").
  static Result<PartFile> open(const std::string& path);
  PartFile(PartFile&& other) noexcept = default;
  PartFile& operator=(PartFile&&) = delete;
  ~PartFile();

  /// Writes `text`, waits until the disk has it, and puts the file into its place, once. Refuses as open().
  Result<void> put(std::string_view text);

 private:
  PartFile(std::string path, std::string part, OwnedDescriptor file) noexcept
      : path_(std::move(path)), part_(std::move(part)), file_(std::move(file)) {}

  std::string path_, part_;
  OwnedDescriptor file_;
};

}  // namespace chimera
