// SPDX-License-Identifier: Apache-2.0
// The tasks of a board as its rtpu on Linux has them: each has a stand-in, which publishes what the board sent and
// turns its task on the board ON and OFF. docs/formats/link.md.
#pragma once

#include <deque>
#include <vector>

#include "chimera/rtpu/board_line.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/task/abi.h"

namespace chimera {

/// Spec and components of an rtpu with a link. At most one in a process: the methods of the stand-ins find it by
/// themselves. Context: setup.
class BoardTasks {
 public:
  /// The spec outlives this.
  BoardTasks(const ApplicationSpec& spec, RtpuId rtpu);
  BoardTasks(const BoardTasks&) = delete;
  BoardTasks& operator=(const BoardTasks&) = delete;
  ~BoardTasks();

  /// As given, but the tasks of the board have no limits of time: those are judged on the board.
  const ApplicationSpec& spec() const noexcept { return spec_; }
  /// By task; null for those of other rtpus.
  const std::vector<const chimera_component*>& components() const noexcept { return by_task_; }
  BoardLine& line() noexcept { return line_; }

 private:
  struct StandIn {
    chimera_component component{};
    std::vector<chimera_port_decl> ports;
    std::vector<PortSpec> specs;
    std::vector<std::string> names;
  };
  void add(const TaskSpec& task, std::size_t index);

  ApplicationSpec spec_;
  std::vector<TaskSpec> tasks_;
  std::deque<StandIn> stand_ins_;
  std::vector<const chimera_component*> by_task_;
  BoardLine line_;
};

}  // namespace chimera
