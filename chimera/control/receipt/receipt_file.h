// SPDX-License-Identifier: Apache-2.0
// The receipts of a subsystem on the disk, one line of JSON each: docs/formats/receipt.md, "The file".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"

namespace chimera::control {

/// FOLDER/receipts.jsonl, and FOLDER/receipts.1.jsonl with those before them. Context of all: setup; may block.
class ReceiptFile {
 public:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{8} << 20;

  /// A file of `most` bytes and more gets the other name before the next receipt.
  explicit ReceiptFile(std::string folder, std::uint64_t most = kMostBytes) : folder_(std::move(folder)), most_(most) {}

  /// Puts the receipts, each one line without its end, behind the others, in one go, but for those that are there
  /// already: after a refusal, or one's own death, the same may be filed again. Makes the folder. Refuses, with the
  /// path in `where`, what the system refuses.
  Result<void> file(const std::vector<std::string>& receipts);
  /// The last `n`, in the order in which they were filed. None where there is no file that can be read.
  std::vector<std::string> last(std::size_t n) const;
  std::string path() const { return folder_ + "/receipts.jsonl"; }
  std::string path_before() const { return folder_ + "/receipts.1.jsonl"; }

 private:
  std::string folder_;
  std::uint64_t most_;
  bool is_known_ = false;  // what it has of those that may be filed again
};

/// Number and run of a receipt, with which its line begins: no other receipt has both. Context: any.
std::string_view receipt_key(std::string_view line) noexcept;

}  // namespace chimera::control
