// SPDX-License-Identifier: Apache-2.0
// The methods `try`, `scope`, `result` and `halt`. Each trial is a command of chimera, run as a child of chimera-web in
// a private folder. docs/formats/web.md, "Trials".
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "chimera/control/control_backend.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/process.h"
#include "chimera/web/draft_methods.h"

namespace chimera::web {

/// Context: setup; may block on the disk.
class Trials {
 public:
  static constexpr std::size_t kMostRunning = 4, kMostKept = 10;
  static constexpr Nanoseconds kTryLimit = seconds(60);
  /// From SIGINT to SIGKILL: `chimera run` itself waits 2 s for a method that does not return, and then names it.
  static constexpr Nanoseconds kEndLimit = seconds(4);
  static constexpr std::uint64_t kMemory = std::uint64_t{1} << 30, kMostBytes = std::uint64_t{16} << 20;

  /// `program`: of chimera. `folder`: of the folders of trials, or "". `file`: the description, or "". `clock` outlives
  /// it.
  Trials(std::string program, std::string folder, std::string file, Clock& clock)
      : program_(std::move(program)), folder_(std::move(folder)), file_(std::move(file)), clock_(clock) {}
  Trials(const Trials&) = delete;
  Trials& operator=(const Trials&) = delete;
  ~Trials() { finish(); }

  static constexpr bool carries_out(control::MethodId method) noexcept {
    return method >= control::MethodId::kTry && method <= control::MethodId::kHalt;
  }
  /// `draft`: null without FILE.
  void call(control::MethodId method, const Json& parameters, const control::Caller& caller,
            const control::Reply& reply, DraftMethods* draft);
  /// The connection is over: halts what it asked for.
  void forget(std::uint64_t connection);

  /// Each is readable when a child has ended; negative numbers are none.
  void append_descriptors(std::vector<int>& all) const;
  Nanoseconds next_due() const noexcept;
  /// Collects what has ended, and ends what must end.
  void serve();
  /// Kills what runs, and removes the folder: this process ends.
  void finish();

 private:
  struct Trial {
    std::uint64_t number = 0, connection = 0;
    std::string folder = {}, why = {};  // `why`: "": it ends by itself
    Process process = {};
    Nanoseconds began = {}, ended = {}, stop_at = kNever, kill_at = kNever;
    std::optional<ProcessEnd> end = {};
  };

  void try_draft(const Json& parameters, std::uint64_t connection, const control::Reply& reply, DraftMethods& draft);
  control::RpcResponse try_text(const Json& parameters, const Json& analysis, std::uint64_t connection);
  control::RpcResponse scope(const Json& parameters, std::uint64_t connection);
  control::RpcResponse result(const Trial& trial) const;
  control::RpcResponse start(std::vector<std::string> words, const std::string& text, Nanoseconds limit,
                             std::uint64_t connection);
  Result<void> make_place();
  Result<void> prepare(const Trial& trial, const std::string& text) const;
  std::string plain(const Trial& trial, std::string text) const;
  void stop(Trial& trial, const char* why);

  std::string program_, folder_, file_;
  Clock& clock_;
  std::string place_;  // in folder_, of this process; "": nothing was started yet
  std::uint64_t last_ = 0;
  std::list<Trial> all_;
};

}  // namespace chimera::web
