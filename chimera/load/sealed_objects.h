// SPDX-License-Identifier: Apache-2.0
// The objects of an application as they were at the start of its run: docs/formats/processes.md, "Shared segments".
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

/// File contents by path. A file that is rebuilt or removed during the run changes nothing here. So an rtpu that is
/// restarted after its death runs the code that was verified.
class SealedObjects {
 public:
  /// Packs the contents of each file once, in the form that open() reads. Refuses the same files as
  /// SharedObject::read(). Context: setup; may block.
  static Result<std::vector<std::byte>> pack(std::span<const std::string> paths);
  /// Opens the bytes from pack(); `bytes` must outlive this object. Refuses truncated bytes. Context: setup.
  static Result<SealedObjects> open(std::span<const std::byte> bytes);

  /// Links the object that was at `path`. Refuses like SharedObject::open(), and refuses a path that was not packed
  /// (kNotFound). Context: setup; may block.
  Result<SharedObject> link(const std::string& path) const;

 private:
  std::map<std::string, std::span<const std::byte>, std::less<>> contents_;
};

}  // namespace chimera
