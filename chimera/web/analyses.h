// SPDX-License-Identifier: Apache-2.0
// The analyst of the bench: the process that reads every text, started with the components as they are now.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/manager/answer/questions.h"
#include "chimera/platform/clock.h"
#include "chimera/web/bench_library.h"

namespace chimera::web {

/// Context of all functions: setup.
class Analyst {
 public:
  /// As manager::Questions::Take.
  using Take = std::function<void(const control::RpcResponse& answer, std::string_view edited)>;

  /// Number of the library of the next question: another one means other answers.
  virtual std::uint64_t library() = 0;
  virtual void ask(manager::Question question, std::uint64_t connection, Take take) = 0;

 protected:
  ~Analyst() = default;
};

/// One analyst for each library that still has a question to answer. Context: setup; blocks for the start of a process
/// and while the library is read.
class Analyses final : public Analyst {
 public:
  using Tell = std::function<void(const std::string&)>;

  /// `program`: of chimera-manager. `library` and `clock` outlive it.
  Analyses(std::string program, BenchLibrary& library, Clock& clock, Tell tell)
      : program_(std::move(program)), library_(library), clock_(clock), tell_(std::move(tell)) {}

  std::uint64_t library() override { return library_.version(); }
  void ask(manager::Question question, std::uint64_t connection, Take take) override;
  void forget(std::uint64_t connection);

  /// Each is readable when serve() has an answer to read.
  std::vector<int> descriptors() const;
  Nanoseconds next_due() const noexcept;
  void serve();

 private:
  struct Generation {
    std::uint64_t library = 0;
    FrozenBytes bundle;
    std::unique_ptr<manager::Questions> questions;
  };

  std::string program_;
  BenchLibrary& library_;
  Clock& clock_;
  Tell tell_;
  std::vector<std::unique_ptr<Generation>> all_;  // the last one gets the questions
};

}  // namespace chimera::web
