// SPDX-License-Identifier: Apache-2.0
// A thread that reads and files receipts, so that a disk that is slow, full or stalled holds nobody up.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/base/time.h"

namespace chimera::manager {

/// One job at a time; the first, which nobody asks for, is to read what is filed. Context: setup; does not block but
/// where it says so. A thread that a disk holds up is left behind.
class ReceiptWriter {
 public:
  struct Done {
    std::vector<std::string> found;  ///< of the first job: the last receipts of the file
    std::string fault;               ///< why the receipts of the job may not be on the disk; "": they are
  };

  /// Files into that folder. Refuses when there is no descriptor or thread for it.
  static Result<std::unique_ptr<ReceiptWriter>> start(const std::string& folder, std::size_t n_found);
  ReceiptWriter(const ReceiptWriter&) = delete;
  ReceiptWriter& operator=(const ReceiptWriter&) = delete;
  ~ReceiptWriter();

  /// Readable when take() has something.
  int descriptor() const noexcept;
  bool is_busy() const noexcept { return is_busy_; }
  /// Requires: !is_busy().
  void file(std::vector<std::string> receipts);
  /// What became of the job, once; it is busy until then.
  std::optional<Done> take();
  /// Blocks until take() has something, at most so long.
  void await(Nanoseconds limit) const;

 private:
  struct Shared;
  explicit ReceiptWriter(std::shared_ptr<Shared> shared) noexcept : shared_(std::move(shared)) {}

  std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this
  bool is_busy_ = true;
};

}  // namespace chimera::manager
