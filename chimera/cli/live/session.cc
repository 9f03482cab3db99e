// SPDX-License-Identifier: Apache-2.0
// Finds the subsystem that is meant, and gives each method the time that it may take.
#include "chimera/cli/live/session.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/cli/live/answer_text.h"
#include "chimera/cli/live/fields.h"

namespace chimera::cli {
namespace {

// A signal may run `init` of many tasks, each with seconds of its own, an analysis take what it needs: as long as the
// manager gives a sign of life.
constexpr Nanoseconds kWorkLimit = seconds(65);

Nanoseconds limit_of(std::string_view method, const nlohmann::json& parameters) {
  const bool runs_methods = method == "signal" && parameters.value("signal", "") != "off";
  return runs_methods || method == "check" || method == "schedule" ? kWorkLimit : control::kCallLimit;
}

}  // namespace

CommandResult refused(const control::RpcResponse& answer, bool json) {
  const nlohmann::json data = answer.data ? *answer.data : nlohmann::json();
  if (!json) return {"", refusal_text(answer.message, data) + "\n", kRefused};
  nlohmann::json error = data.is_object() ? data : nlohmann::json::object();
  error["message"] = answer.message;
  error["code"] = answer.code;
  if (!error.contains("where")) error["where"] = "";
  return {json_line({{"error", std::move(error)}}), "", kRefused};
}

CommandResult refused(const Error& error, bool json, int code) {
  const std::string message(error.message.view()), where(error.where.view());
  if (json) return {json_line({{"error", {{"where", where}, {"message", message}}}}), "", code};
  return {"", (where.empty() ? "" : where + ": ") + plain_line(message) + "\n", code};
}

CommandResult answered(const control::RpcResponse& answer, bool json,
                       const std::function<std::string(const nlohmann::json&)>& show) {
  if (!answer.is_good()) return refused(answer, json);
  return {json ? answer.result->dump() + "\n" : show(*answer.result), "", kOk};
}

Result<Session> Session::open(const Surroundings& surroundings) {
  auto client = control::Client::connect(surroundings.subsystem);
  if (!client) return client.error();
  const char* chosen = std::getenv("CHIMERA_SUBSYSTEM");
  Session session(std::move(client).value(), surroundings);
  session.is_named_ = !surroundings.subsystem.empty() || (chosen != nullptr && *chosen != '\0');
  return session;
}

const control::Home& Session::home() {
  if (home_.subsystem.empty()) (void)hello();
  return home_;
}

control::RpcResponse Session::hello() {
  const control::RpcResponse hello = ask("hello");
  if (hello.is_good()) home_ = control::home_of(*hello.result);
  return hello;
}

const std::string& Session::subsystem() { return home().subsystem; }

Result<void> Session::may_act() {
  if (is_named_ || control::is_here(home())) return {};
  const std::string name = home().subsystem;
  if (name.empty()) return Error{ErrorCode::kRefused, {"the subsystem did not tell its name"}, {}};
  const std::string folder = home().folder.empty() ? "elsewhere" : "in " + plain_line(home().folder);
  const std::string message =
      "'" + name + "' was started " + folder + " (process " + std::to_string(home().keeper_pid) +
      "), not from this terminal or folder; if you mean it, type: " + surroundings_.command + " --subsystem " + name;
  return Error{ErrorCode::kRefused, std::string_view(message), {}};
}

control::RpcResponse Session::ask(std::string_view method) { return ask(method, nlohmann::json::object()); }

control::RpcResponse Session::ask(std::string_view method, const nlohmann::json& parameters) {
  return client_.call(method, parameters, limit_of(method, parameters), control::kCallLimit);
}

}  // namespace chimera::cli
