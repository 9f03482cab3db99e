// SPDX-License-Identifier: Apache-2.0
// Files a receipt of each takeover that real-time units made by themselves, maybe while no manager was there: once,
// whenever managers die. docs/formats/receipt.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/manager/receipt_archive.h"
#include "chimera/manager/switch_journal.h"
#include "chimera/runtime/takeover.h"

namespace chimera::manager {

/// Context: setup; never blocks.
class TakeoverReceipts {
 public:
  /// Both outlive it.
  TakeoverReceipts(ManagerState& world, ReceiptArchive& archive);
  /// Files what units have told since.
  void look(Nanoseconds now);

 private:
  /// What tells two takeovers of a run apart.
  struct Key {
    std::int64_t asked_ns;
    std::string task;
    bool operator==(const Key&) const = default;
  };

  void look(RtpuId rtpu, Nanoseconds now);
  bool is_possible(const Takeover& takeover, RtpuId rtpu, Nanoseconds now) const;
  void file(const Takeover& takeover, Nanoseconds now);

  ManagerState& world_;
  ReceiptArchive& archive_;
  SwitchJournal journal_;
  std::vector<Key> left_;  // a predecessor kept their receipts, and may have died before it noted that
};

}  // namespace chimera::manager
