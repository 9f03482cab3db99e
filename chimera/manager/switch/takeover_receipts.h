// SPDX-License-Identifier: Apache-2.0
// Files one receipt for each takeover that rtpus made by themselves, maybe while there was no manager. It files each
// one once, no matter when managers die. docs/formats/receipt.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/manager/state/switch_journal.h"
#include "chimera/manager/switch/receipt_archive.h"
#include "chimera/runtime/plan/takeover.h"

namespace chimera::manager {

/// Context: setup; never blocks.
class TakeoverReceipts {
 public:
  /// Both outlive it.
  TakeoverReceipts(ManagerState& state, ReceiptArchive& archive);
  /// Files the takeovers that rtpus have published since the last call.
  void look(Nanoseconds now);

 private:
  /// The data that identifies a takeover in a run.
  struct Key {
    std::int64_t asked_ns;
    std::string task;
    bool operator==(const Key&) const = default;
  };

  void look(RtpuId rtpu, Nanoseconds now);
  bool is_possible(const Takeover& takeover, RtpuId rtpu, Nanoseconds now) const;
  void file(const Takeover& takeover, Nanoseconds now);

  ManagerState& state_;
  ReceiptArchive& archive_;
  SwitchJournal journal_;
  std::vector<Key> left_;  // a predecessor kept their receipts, and may have died before it noted that
};

}  // namespace chimera::manager
