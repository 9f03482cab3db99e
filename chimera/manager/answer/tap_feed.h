// SPDX-License-Identifier: Apache-2.0
// The tap for a subscriber: lossless rows of the publications of some variables' producers, or the scheduling records
// of all rtpus. docs/formats/control.md, "Notifications".
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/runtime/hosted/tap_rows.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// Gets the parameters of one notification, without the subscription.
using TapSink = std::function<void(Json)>;

/// While one lives its tasks are tapped: their rtpus append each publication to their rings. Context: setup.
class TapFeed {
 public:
  /// `variables` empty: scheduling records. `from_oldest`: also the records that are still in the rings; older ones
  /// count as lost. Requires: not idle; `state` outlives it.
  TapFeed(ManagerState& state, const std::vector<VariableId>& variables, bool from_oldest = false);
  ~TapFeed();
  TapFeed(const TapFeed&) = delete;
  TapFeed& operator=(const TapFeed&) = delete;

  /// Passes on the records since the last call, at most 4096. Call it again while it passes records on, and several
  /// times within 0.3 s, because the ring holds no more.
  void pump(const TapSink& sink);

 private:
  /// A variable among the publications of one task.
  struct Column {
    VariableId variable;
    std::uint32_t offset = 0;  // in the payload
  };
  struct Rows {
    TaskId task;
    std::vector<Column> columns;
    std::uint64_t first = 0, lost = 0;
    std::vector<Json> waiting;  // rows for the next message
  };
  struct Ring {
    RtpuId rtpu;
    std::shared_ptr<const PeerSegment> segment;  // whose ring it reads; that of a dead rtpu up to its end
    TapReader reader;
    std::unique_ptr<TapRows> assembler;
    std::uint64_t lost_before = 0;
    std::uint64_t gone = 0;               // lost before it was followed, and not reported yet
    std::uint64_t first = 0;              // of scheduling records
    std::vector<Json> waiting;
  };

  void add_producer(VariableId variable, const PortOf& port);
  void tap(TaskId task, bool up);
  bool follow(Ring& ring);
  bool drain(Ring& ring, std::size_t& left, const TapSink& sink);
  void take(Ring& ring, const TapRecord& record, const TapSink& sink);
  void take_row(const TapRow& row, const TapSink& sink);
  void flush(Rows& rows, const TapSink& sink);
  void flush(Ring& ring, std::uint64_t lost, const TapSink& sink);

  ManagerState& state_;
  const bool from_oldest_;
  std::vector<Rows> rows_;
  std::vector<Ring> rings_;
  std::vector<TapRecord> buffer_;
  std::size_t next_ = 0;  // ring that is read first, counted upward without end
};

}  // namespace chimera::manager
