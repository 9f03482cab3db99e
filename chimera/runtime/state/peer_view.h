// SPDX-License-Identifier: Apache-2.0
// The view that the tasks of one context have of the rest of the application: the other rtpus and the operator. A
// context without others has none. docs/formats/processes.md.
#pragma once

#include <cstddef>

#include "chimera/table/group.h"
#include "chimera/task/task.h"

namespace chimera {

/// Plain value.
struct PeerPresence {
  bool lives = false;     ///< its process does
  bool is_held = false;   ///< it is created in a process that lives, or `init` or `kill` of it is under way there
  bool has_seen = true;   ///< its process has looked at all that this context has shown, or is dead
};

/// Used by the thread of the context, at cycle boundaries; an answer is good until the next one. runtime/changes.h has
/// the changes of this context.
class PeerView {
 public:
  /// State of a task of another context; ERROR when its process is dead. Context: cycle boundary; wait-free.
  virtual State state(TaskId task) const noexcept = 0;
  /// How that task of another context is there. Context: cycle boundary; wait-free.
  virtual PeerPresence presence(TaskId task) const noexcept = 0;
  /// Groups of a task of another context in its present incarnation, and of the operator. Not bound when that
  /// process has not shown its segment yet. Context: cycle boundary; wait-free.
  virtual GroupReader outputs(TaskId task) const noexcept = 0;
  virtual GroupReader constants(TaskId task) const noexcept = 0;
  virtual GroupReader operator_variable(std::size_t index) const noexcept = 0;
  /// Passes a signal on: to the rtpu of `target`; `on` to the manager, who alone turns tasks ON. `is_echo`: a
  /// reinit because a constant changed. False when there is no room. Context: cycle boundary; wait-free.
  virtual bool post(Signal signal, TaskId target, TaskId from, bool is_echo) noexcept = 0;
  /// From now on until this context has shown what it changed, no other context turns a task of that group of standbys
  /// (standbys.h) ON, or creates one for that. False: another one is about to, or the run ends. Context: cycle
  /// boundary; wait-free.
  virtual bool claim(std::size_t /*group*/) noexcept { return true; }
  /// A manager judges which tasks would be ON before it turns tasks ON; false: each context judges that over all
  /// contexts when it takes the signal. Context: cycle boundary; wait-free.
  virtual bool has_manager() const noexcept { return true; }

 protected:
  ~PeerView() = default;
};

}  // namespace chimera
