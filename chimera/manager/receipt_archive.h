// SPDX-License-Identifier: Apache-2.0
// The receipts of the switches of a subsystem: each is kept in the journal, filed on the disk once, and given out.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/manager/receipt_writer.h"
#include "chimera/manager/switch_journal.h"

namespace chimera::manager {

/// Context: setup; never blocks but in flush().
class ReceiptArchive {
 public:
  static constexpr std::size_t kKept = 200;              // that are given out
  static constexpr std::size_t kMostUnfiled = 1000;
  static constexpr Nanoseconds kPatience = milliseconds(100);  // for the disk, before an answer
  static constexpr Nanoseconds kTryAgain = seconds(10);        // after a fault

  /// Takes up what a predecessor has not filed. `folder`: of the files; "": there is none. Refuses what
  /// ReceiptWriter::start refuses. `world` outlives it.
  static Result<std::unique_ptr<ReceiptArchive>> start(ManagerState& world, const std::string& folder);
  ReceiptArchive(const ReceiptArchive&) = delete;
  ReceiptArchive& operator=(const ReceiptArchive&) = delete;

  /// Keeps the receipt of that number, one line of JSON, and files it. `then` is called when it is on the disk, when it
  /// cannot be, or after kPatience; maybe at once.
  void add(std::uint32_t number, std::string receipt, Nanoseconds now, std::function<void()> then);
  /// Readable when look() has something to do; -1: never.
  int descriptor() const noexcept { return writer_ ? writer_->descriptor() : -1; }
  Nanoseconds next_due() const noexcept;
  void look(Nanoseconds now);
  /// Files what is left; blocks for at most that long.
  void flush(Nanoseconds limit);

  /// In the order in which they ended, those of earlier runs first; one line of JSON each.
  const std::deque<std::string>& kept() const noexcept { return kept_; }
  std::size_t unfiled() const noexcept { return unfiled_.size(); }
  const std::string& path() const noexcept { return path_; }    ///< "": there is no file
  const std::string& fault() const noexcept { return fault_; }  ///< why the last ones are not filed; "": they are

 private:
  struct Unfiled {
    std::uint32_t number;
    std::string receipt;
  };
  struct Waiting {
    std::uint32_t number;
    Nanoseconds until;
    std::function<void()> then;
  };

  explicit ReceiptArchive(ManagerState& world);
  void keep(std::string receipt);
  void take_found(const std::vector<std::string>& found);
  void take_done(const ReceiptWriter::Done& done, Nanoseconds now);
  void file_next(Nanoseconds now);
  void answer(const std::function<bool(const Waiting&)>& is_due);
  bool is_unfiled(std::uint32_t number) const;

  ManagerState& world_;
  SwitchJournal journal_;
  std::unique_ptr<ReceiptWriter> writer_;  // null: there is no folder
  std::string path_, fault_;
  std::deque<std::string> kept_;
  std::deque<Unfiled> unfiled_;
  std::size_t in_flight_ = 0;  // of unfiled_, the first ones: what the writer has
  std::vector<Waiting> waiting_;
  bool has_found_ = false;
  Nanoseconds tries_again_;    // not before
};

}  // namespace chimera::manager
