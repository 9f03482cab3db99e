// SPDX-License-Identifier: Apache-2.0
// A description brought to the point where an executor can take it: verified, its objects loaded, its tasks made.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/cli/run/expectation.h"
#include "chimera/runtime/hosted/background_writer.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/virtual/virtual_peers.h"
#include "chimera/text/value_text.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {

/// One state variable that any thread may read.
class Probe {
 public:
  /// The latest publication of the operator and of the producers that are ON; if there are none, the latest of all.
  /// False when the variable was never written. Context: any thread; bounded.
  bool read(std::vector<std::byte>& value) const;
  /// The latest publication as text and numbers.
  Seen sample() const;

  std::string name;
  ValueForm form;
  std::vector<VariableReader> readers;
  std::vector<const Task*> producers;  ///< one for each reader; null: the operator
};

/// Its tasks are on more than one rtpu. Context: setup.
bool are_on_several_rtpus(const Configuration& configuration) noexcept;

/// Context: setup. Movable.
class Application {
 public:
  enum class Contexts : std::uint8_t {
    kOne,    ///< all tasks in one
    kByRtpu  ///< one for each rtpu, where tasks are on several: virtual time
  };
  /// Opens the shared object of every component used and makes the tasks, in NOT-CREATED.
  static Result<Application> load(Configuration configuration, const Library& library,
                                  Contexts contexts = Contexts::kOne);

  const Configuration& configuration() const noexcept { return configuration_; }
  const ApplicationSpec& spec() const noexcept { return configuration_.spec(); }
  /// The parts of the contexts that the others see; null: there is one context.
  VirtualPeers* peers() noexcept { return peers_.get(); }
  /// Requires: one context.
  TaskSet& tasks() noexcept { return *contexts_[0]; }
  /// Every task, in order.
  std::vector<const Task*> all_tasks() const;
  /// The state of every task, in order; ERROR on a dead rtpu.
  std::vector<State> states() const;
  /// The illegal-configuration flag is up.
  bool is_flag_up() const noexcept;
  /// For real time: threads for what components do beside their cycles (RunOptions::writer).
  BackgroundWriter& background_writer() noexcept { return *writer_; }
  /// A probe for the state variable of that name; refuses an unknown name with the nearest one.
  /// Extents that constants fix are read when the tasks have been initialised.
  Result<Probe> probe(const std::string& variable) const;

 private:
  explicit Application(Configuration configuration) : configuration_(std::move(configuration)) {}
  Result<void> make_contexts(ContextPlace place, Contexts contexts);
  TaskSet& context_of(TaskId task) const noexcept;
  VariableView view(VariableId variable) const noexcept;

  Configuration configuration_;
  std::vector<const chimera_component*> components_;
  std::unique_ptr<BackgroundWriter> writer_ = std::make_unique<BackgroundWriter>();
  std::unique_ptr<VirtualPeers> peers_;
  std::vector<std::unique_ptr<HeapTaskSet>> contexts_;  // one; with peers_ by rtpu, null: no task is on it
};

/// The names of the numbers of a variable, in the order of Seen::numbers: "error"; of a list "q[0]"; of a struct
/// "target.position[2]". Context: setup.
std::vector<std::string> number_names(const Probe& probe);
/// The unit of each number. Context: setup.
std::vector<std::string> number_units(const Probe& probe);

}  // namespace chimera::cli
