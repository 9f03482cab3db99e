// SPDX-License-Identifier: Apache-2.0
// One subsystem, asked the way commands ask: which one it is, whether an act may go to it, how long an answer may take;
// and any command on it carried out, wherever it was typed.
#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/cli/command/command.h"
#include "chimera/cli/command/command_result.h"
#include "chimera/control/client.h"
#include "chimera/control/home.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// The surroundings of a session.
struct Surroundings {
  std::string subsystem;                ///< as asked for; "" when the choice is clear
  std::vector<std::string> unit_files;  ///< in the order in which they are tried
  std::string command = {};             ///< what was typed, to be typed again: "chimera off pid"
};

/// A refusal as a command says it: the words on standard error, or {"error": {...}} on standard output.
/// Context of all: setup.
CommandResult refused(const control::RpcResponse& answer, bool json);
CommandResult refused(const Error& error, bool json, int code = kRefused);
/// The answer as it came (`json`), or what `show` makes of it; or the refusal.
CommandResult answered(const control::RpcResponse& answer, bool json,
                       const std::function<std::string(const Json&)>& show);

/// Context: setup; calls block, never longer than their limit.
class Session {
 public:
  /// Refuses as control::Client does.
  static Result<Session> open(const Surroundings& surroundings);

  control::Client& client() noexcept { return client_; }
  const Surroundings& surroundings() const noexcept { return surroundings_; }
  /// True if the user named the subsystem, by option or by CHIMERA_SUBSYSTEM.
  bool is_named() const noexcept { return is_named_; }
  /// Calls `hello`, with which every command begins, and returns its answer.
  control::RpcResponse hello();
  /// The name of the subsystem from the answer of `hello`; "" when it does not answer.
  const std::string& subsystem();
  /// Permits an act if the subsystem was named, or belongs to this terminal or folder. Else refuses, with the command
  /// to type.
  Result<void> may_act();
  /// As control::Client::call, with the time that the method may take.
  control::RpcResponse ask(std::string_view method);
  control::RpcResponse ask(std::string_view method, const Json& parameters);

 private:
  Session(control::Client client, Surroundings surroundings)
      : client_(std::move(client)), surroundings_(std::move(surroundings)) {}
  const control::Home& home();

  control::Client client_;
  Surroundings surroundings_;
  bool is_named_ = false;
  control::Home home_;
};

/// Carries out `call` (not the shell's own `help` and `quit`) and prints what it says. Returns its exit code.
/// Context: setup; blocks until it is over.
int carry_out(Session& session, const Call& call, std::FILE* out, std::FILE* err);

/// carry_out() over a new connection to the subsystem that `surroundings` names.
int carry_out(const Surroundings& surroundings, const Call& call, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
