// SPDX-License-Identifier: Apache-2.0
// What the tasks of one context know of the rest of the application: the other rtpus and the operator. A context
// without others has none. docs/formats/processes.md.
#pragma once

#include <cstddef>

#include "chimera/table/group.h"
#include "chimera/task/task.h"

namespace chimera {

/// Asked and told by the thread of the context, at edges. What it answers is good until the next edge.
class Neighbours {
 public:
  /// State of a task of another context; ERROR when its process is dead. Context: edge; wait-free.
  virtual State state(TaskId task) const noexcept = 0;
  /// Groups of a task of another context in its present incarnation, and of the operator. Not bound when that
  /// process has not shown its segment yet. Context: edge; wait-free.
  virtual GroupReader outputs(TaskId task) const noexcept = 0;
  virtual GroupReader constants(TaskId task) const noexcept = 0;
  virtual GroupReader operator_variable(std::size_t index) const noexcept = 0;
  /// Passes a signal on: to the rtpu of `target`; `on` to the manager, who alone turns tasks ON. `is_echo`: a
  /// reinit because a constant changed. False when there is no room. Context: edge; wait-free.
  virtual bool post(Signal signal, TaskId target, TaskId from, bool is_echo) noexcept = 0;
  /// The state of some task of this context, or its legality, changed. Context: edge; wait-free.
  virtual void changed() noexcept = 0;
  /// A method of the task failed, or left a note: its fault record is new. Context: edge; wait-free.
  virtual void told(const Task& task) noexcept = 0;

 protected:
  ~Neighbours() = default;
};

}  // namespace chimera
