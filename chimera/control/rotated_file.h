// SPDX-License-Identifier: Apache-2.0
// The receipts or events of a subsystem on the disk, one line of JSON each: docs/formats/receipt.md, "The files".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"

namespace chimera::control {

/// FOLDER/STEM.jsonl, and FOLDER/STEM.1.jsonl with the lines before them. Context of all: setup; may block.
class RotatedFile {
 public:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{8} << 20;

  /// A file that new lines would make longer than `most` bytes gets the other name first.
  RotatedFile(const std::string& folder, const std::string& stem, std::uint64_t most = kMostBytes)
      : folder_(folder), stem_(folder + "/" + stem), most_(most) {}

  /// Appends the lines, each without its end, in one go. Leaves out those that are there already: after a refusal, or
  /// the death of a manager, a line may be filed again. Makes the folder. Refuses, with the path in `where`, what the
  /// system refuses.
  Result<void> file(const std::vector<std::string>& lines);
  /// The last `n`, in the order in which they were filed; only those whose line_key() ends with `run`. None if there is
  /// no file that can be read. Skips lines that are cut or that another program has written.
  std::vector<std::string> last(std::size_t n, std::string_view run = {}) const;
  std::string path() const { return stem_ + ".jsonl"; }
  std::string path_before() const { return stem_ + ".1.jsonl"; }

 private:
  std::string folder_, stem_;
  std::uint64_t most_;
  bool is_known_ = false;  // the file has no line that may be filed again
};

/// Number and run, with which a line begins: `{"number": 1, "origin_ns": 7, `. No other line has both. Context: any.
std::string_view line_key(std::string_view line) noexcept;

}  // namespace chimera::control
