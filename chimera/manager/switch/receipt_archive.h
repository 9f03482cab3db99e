// SPDX-License-Identifier: Apache-2.0
// The receipts of the switches of a subsystem: kept in the journal, filed on the disk once, and given to clients.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "chimera/manager/state/filing.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/manager/state/switch_journal.h"

namespace chimera::manager {

/// Context: setup.
class ReceiptArchive {
 public:
  static constexpr std::size_t kKept = 200;                     // receipts that clients can get
  static constexpr Nanoseconds kDiskLimit = milliseconds(100);  // an answer waits for the disk, but no longer than this

  /// Takes over the receipts that a predecessor has not filed. `folder`: for the files; "": there is none. Refuses if a
  /// descriptor or thread cannot be made. `state` outlives it.
  static Result<std::unique_ptr<ReceiptArchive>> start(ManagerState& state, const std::string& folder);
  ReceiptArchive(const ReceiptArchive&) = delete;
  ReceiptArchive& operator=(const ReceiptArchive&) = delete;

  /// Keeps the receipt of that number, one line of JSON, and files it. Calls `then` when it is on the disk, when it
  /// cannot be filed, or after kDiskLimit; maybe at once.
  void add(std::uint32_t number, std::string receipt, Nanoseconds now, std::function<void()> then);
  /// Readable when look() has a finished job; -1: never.
  int descriptor() const noexcept { return filing_->descriptor(); }
  Nanoseconds next_due() const noexcept;
  void look(Nanoseconds now);
  Filing& filing() const noexcept { return *filing_; }

  /// Receipts in the order of their ends, those of earlier runs first; one line of JSON each.
  const std::deque<std::string>& kept() const noexcept { return kept_; }
  std::size_t unfiled() const noexcept { return filing_->unfiled().size(); }
  const std::string& path() const noexcept { return filing_->path(); }
  const std::string& fault() const noexcept { return filing_->fault(); }

 private:
  struct Waiting {
    std::uint32_t number;
    Nanoseconds until;
    std::function<void()> then;
  };

  ReceiptArchive(ManagerState& state, std::unique_ptr<Filing> filing);
  void keep(std::string receipt);
  void take_found(const std::vector<std::string>& found);
  void answer(const std::function<bool(const Waiting&)>& is_due);

  SwitchJournal journal_;
  std::unique_ptr<Filing> filing_;
  std::deque<std::string> kept_;
  std::vector<Waiting> waiting_;
};

}  // namespace chimera::manager
