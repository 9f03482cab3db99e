// SPDX-License-Identifier: Apache-2.0
// The receipts of the switches of a subsystem: kept in the journal, filed on the disk once, and given to clients.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/manager/state/switch_journal.h"

namespace chimera::manager {

/// Context: setup; blocks only in flush().
class ReceiptArchive {
 public:
  static constexpr std::size_t kKept = 200;              // receipts that clients can get
  static constexpr std::size_t kMostUnfiled = 1000;
  static constexpr Nanoseconds kDiskLimit = milliseconds(100);  // an answer waits for the disk, but no longer than this
  static constexpr Nanoseconds kTryAgain = seconds(10);         // after a fault

  /// Takes over the receipts that a predecessor has not filed. `folder`: for the files; "": there is none. Refuses if a
  /// descriptor or thread cannot be made. `state` outlives it.
  static Result<std::unique_ptr<ReceiptArchive>> start(ManagerState& state, const std::string& folder);
  ReceiptArchive(const ReceiptArchive&) = delete;
  ReceiptArchive& operator=(const ReceiptArchive&) = delete;
  ~ReceiptArchive();

  /// Keeps the receipt of that number, one line of JSON, and files it. Calls `then` when it is on the disk, when it
  /// cannot be filed, or after kDiskLimit; maybe at once.
  void add(std::uint32_t number, std::string receipt, Nanoseconds now, std::function<void()> then);
  /// Readable when look() has a finished job; -1: never.
  int descriptor() const noexcept;
  Nanoseconds next_due() const noexcept;
  void look(Nanoseconds now);
  /// The next look() tries again after a fault, before kTryAgain is over.
  void try_again(Nanoseconds now) noexcept { tries_again_ = now; }
  /// Files the receipts that are left; blocks for `limit` at most.
  void flush(Nanoseconds limit);

  /// Receipts in the order of their ends, those of earlier runs first; one line of JSON each.
  const std::deque<std::string>& kept() const noexcept { return kept_; }
  std::size_t unfiled() const noexcept { return unfiled_.size(); }
  const std::string& path() const noexcept { return path_; }    ///< "": there is no file
  const std::string& fault() const noexcept { return fault_; }  ///< why the last ones are not filed; "": they are filed

 private:
  class Writer;
  struct Unfiled {
    std::uint32_t number;
    std::string receipt;
  };
  struct Waiting {
    std::uint32_t number;
    Nanoseconds until;
    std::function<void()> then;
  };

  explicit ReceiptArchive(ManagerState& state);
  void keep(std::string receipt);
  void take_found(const std::vector<std::string>& found);
  void take_done(const std::string& fault, Nanoseconds now);
  void file_next(Nanoseconds now);
  void answer(const std::function<bool(const Waiting&)>& is_due);
  bool is_unfiled(std::uint32_t number) const;

  ManagerState& state_;
  SwitchJournal journal_;
  std::unique_ptr<Writer> writer_;  // null: there is no folder
  std::string path_, fault_;
  std::deque<std::string> kept_;
  std::deque<Unfiled> unfiled_;
  std::size_t in_flight_ = 0;  // number of first entries of unfiled_ that the writer has
  std::vector<Waiting> waiting_;
  bool has_found_ = false;
  Nanoseconds tries_again_;    // earliest time of the next try
};

}  // namespace chimera::manager
