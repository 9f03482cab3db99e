// SPDX-License-Identifier: Apache-2.0
// Finds the subsystem that is meant, gives each method the time that it may take, and carries out a call by its row.
#include "chimera/cli/live/session.h"

#include <cstdlib>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/terminal.h"
#include "chimera/cli/print/answer_text.h"
#include "chimera/cli/print/fields.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

// A signal may run `init` of many tasks, each with seconds of its own, an analysis take what it needs: as long as the
// manager gives a sign of life.
constexpr Nanoseconds kWorkLimit = seconds(65);

Nanoseconds limit_of(std::string_view method, const Json& parameters) {
  if (method == "switch" || method == "drill")
    return kWorkLimit + milliseconds(whole_at(parameters, "wait_ms", 10'000));
  if (method == "cancel") return kWorkLimit;
  const bool runs_methods = method == "signal" && text_at(parameters, "signal") != "off";
  return runs_methods || method == "check" || method == "schedule" ? kWorkLimit : control::kCallLimit;
}

/// Every line behind the name of the subsystem that it comes from: "[puma_pid] pid: ON -> OFF".
std::string behind_name(const std::string& text, const std::string& subsystem) {
  std::string named;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size() - 1);
    named += "[" + subsystem + "] " + text.substr(from, end + 1 - from);
    from = end + 1;
  }
  return named;
}

/// With "subsystem" as its first key, where the text is one object.
std::string with_subsystem(const std::string& text, const std::string& subsystem) {
  auto answer = Json::parse_or_none(text);
  if (!answer || !answer->is_object()) return text;
  (*answer)["subsystem"] = subsystem;
  return json_line(*answer);
}

/// Puts the name of the subsystem into the result of an act, also when it was refused.
CommandResult named(CommandResult said, Session& session, const Call& call) {
  if (call.json) return said.out = with_subsystem(said.out, session.subsystem()), said;
  if (!call.is_act() || row_of(call).names_its_subsystem) return said;
  said.out = behind_name(said.out, session.subsystem());
  said.err = behind_name(said.err, session.subsystem());
  return said;
}

}  // namespace

CommandResult refused(const control::RpcResponse& answer, bool json) {
  const Json data = answer.data ? *answer.data : Json();
  if (!json) return {"", refusal_text(answer.message, data) + "\n", kRefused};
  Json error = data.is_object() ? data : Json::object();
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
                       const std::function<std::string(const Json&)>& show) {
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

control::RpcResponse Session::ask(std::string_view method) { return ask(method, Json::object()); }

control::RpcResponse Session::ask(std::string_view method, const Json& parameters) {
  return client_.call(method, parameters, limit_of(method, parameters), control::kCallLimit);
}

int carry_out(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  if (call.is_act())
    if (const auto may = session.may_act(); !may) return print(refused(may.error(), call.json), out, err);
  (void)session.subsystem();  // asked before the act: after an `end` the manager is gone
  const RunningCommand& row = row_of(call);
  if (row.is_live(call)) return row.live(session, call, out, err);
  const ScreenSize size = screen_size(kStandardOutput);
  const Screen screen{is_terminal(kStandardOutput) ? size.width : 0, size.height, err};
  CommandResult said = one_shot(session, call, screen);
  return print(named(std::move(said), session, call), out, err);
}

int carry_out(const Surroundings& surroundings, const Call& call, std::FILE* out, std::FILE* err) {
  const RunningCommand& row = row_of(call);
  Surroundings known = surroundings;
  known.command = command_line(call);
  if (row.without != nullptr && !call.operands.empty()) known.subsystem = call.operand(0);
  auto session = Session::open(known);
  if (!session && row.without != nullptr) return print(row.without(call, known.subsystem, session.error()), out, err);
  if (!session) return print(refused(session.error(), call.json), out, err);
  // A manager that does not answer now does not answer the command either: one limit, not one for each question.
  if (const control::RpcResponse hello = session->hello(); !hello.is_good())
    return print(refused(hello, call.json), out, err);
  // A user who named no subsystem learns its name; status and top begin with it, an act says it in every line.
  const bool says_itself = call.json || call.is_act() || row.names_its_subsystem;
  if (!session->is_named() && !says_itself) std::fprintf(err, "[%s]\n", session->subsystem().c_str());
  return carry_out(*session, call, out, err);
}

}  // namespace chimera::cli
