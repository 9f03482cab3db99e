// SPDX-License-Identifier: Apache-2.0
// The events of a subsystem in the journal and on the disk, so that they outlive the manager.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "chimera/manager/state/filing.h"
#include "chimera/manager/state/manager_state.h"

namespace chimera::manager {

/// Context: setup.
class EventArchive {
 public:
  /// Files each event of `state` from here on, and those that a predecessor left. `folder`: for the files; "": there is
  /// none. Refuses if a descriptor or thread cannot be made. `state` outlives it.
  static Result<std::unique_ptr<EventArchive>> start(ManagerState& state, const std::string& folder);
  EventArchive(const EventArchive&) = delete;
  EventArchive& operator=(const EventArchive&) = delete;
  ~EventArchive() { state_.keep = nullptr; }

  /// Files, and gives the log the events of dead managers when they are read.
  void look(Nanoseconds now);
  Filing& filing() const noexcept { return *filing_; }

 private:
  EventArchive(ManagerState& state, std::unique_ptr<Filing> filing);
  void recall(std::vector<std::string> found, Nanoseconds now);

  ManagerState& state_;
  LineJournal journal_;
  std::unique_ptr<Filing> filing_;
  std::vector<Filing::Line> left_;  // that the predecessor had not filed, until they are in the log
};

}  // namespace chimera::manager
