// SPDX-License-Identifier: Apache-2.0
// A thread that reads and files receipts, so that a slow, full or stalled disk delays no one else.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/base/time.h"

namespace chimera::manager {

/// One job at a time; the first job, made at the start, reads the filed receipts. Context: setup; blocks only where
/// stated. A thread that a disk stalls is left behind.
class ReceiptWriter {
 public:
  struct Done {
    std::vector<std::string> found;  ///< by the first job: the last receipts of the file
    std::string fault;               ///< why the receipts of the job may not be on the disk; "": they are
  };

  /// Files into that folder. Refuses if a descriptor or thread cannot be made.
  static Result<std::unique_ptr<ReceiptWriter>> start(const std::string& folder, std::size_t n_found);
  ReceiptWriter(const ReceiptWriter&) = delete;
  ReceiptWriter& operator=(const ReceiptWriter&) = delete;
  ~ReceiptWriter();

  /// Readable when take() has a result.
  int descriptor() const noexcept;
  bool is_busy() const noexcept { return is_busy_; }
  /// Requires: !is_busy().
  void file(std::vector<std::string> receipts);
  /// The result of the job, once; is_busy() until then.
  std::optional<Done> take();
  /// Blocks until take() has a result, `limit` at most.
  void await(Nanoseconds limit) const;

 private:
  struct Shared;
  explicit ReceiptWriter(std::shared_ptr<Shared> shared) noexcept : shared_(std::move(shared)) {}

  std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this
  bool is_busy_ = true;
};

}  // namespace chimera::manager
