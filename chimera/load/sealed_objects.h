// SPDX-License-Identifier: Apache-2.0
// The objects of an application as they were when its run began: docs/formats/processes.md, "Shared segments".
//
//   files -> one sealed memory, made by the keeper -> every rtpu and each of its successors links from it
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/load/shared_object.h"

namespace chimera {

/// Contents by path. A file that is built anew or removed while the application runs changes nothing here, so a unit
/// that dies comes back with the code that was verified.
class SealedObjects {
 public:
  /// The contents of the files, each once, as open() reads them. Refuses what SharedObject::read() refuses. Context:
  /// setup; may block.
  static Result<std::vector<std::byte>> pack(std::span<const std::string> paths);
  /// What pack() made; `bytes` outlive this. Refuses bytes that are cut short. Context: setup.
  static Result<SealedObjects> open(std::span<const std::byte> bytes);

  /// Links the object that was at `path`. Refuses as SharedObject::open(), and (kNotFound) a path that was not packed.
  /// Context: setup; may block.
  Result<SharedObject> link(const std::string& path) const;

 private:
  std::map<std::string, std::span<const std::byte>, std::less<>> contents_;
};

}  // namespace chimera
