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
#include "chimera/text/value_text.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {

/// One state variable to look at, from any thread.
class Probe {
 public:
  /// The latest publication of a producer that is ON, or of the operator; of nobody in force, the latest of all. False
  /// when nobody has written it yet. Context: any thread; bounded.
  bool read(std::vector<std::byte>& value) const;
  /// The latest publication as text and numbers.
  Seen sample() const;

  std::string name;
  ValueForm form;
  std::vector<VariableReader> readers;
  std::vector<const Task*> producers;  ///< one for each reader; null: the operator
};

/// Context: setup. Movable.
class Application {
 public:
  /// Opens the shared object of every component used and makes the tasks, in NOT-CREATED.
  static Result<Application> load(Configuration configuration, const Library& library);

  const Configuration& configuration() const noexcept { return configuration_; }
  TaskSet& tasks() noexcept { return *tasks_; }
  /// For real time: threads for what components do beside their cycles (RunOptions::writer).
  BackgroundWriter& background_writer() noexcept { return *writer_; }
  /// A probe for the state variable of that name; refuses an unknown name with the nearest one.
  /// Extents that constants fix are read when the tasks have been initialised.
  Result<Probe> probe(const std::string& variable) const;

 private:
  explicit Application(Configuration configuration) : configuration_(std::move(configuration)) {}

  Configuration configuration_;
  std::vector<const chimera_component*> components_;
  std::unique_ptr<BackgroundWriter> writer_ = std::make_unique<BackgroundWriter>();
  std::unique_ptr<HeapTaskSet> tasks_;
};

}  // namespace chimera::cli
