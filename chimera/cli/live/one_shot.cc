// SPDX-License-Identifier: Apache-2.0
// Carries out the commands that ask more than once or read their options themselves.
#include "chimera/cli/live/one_shot.h"

#include <algorithm>
#include <map>

#include "chimera/analysis/recorded_profile.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/base/message.h"
#include "chimera/cli/live/save_file.h"
#include "chimera/cli/live/words.h"
#include "chimera/cli/print/answer_text.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/status_text.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {
namespace {

CommandResult wrong(const std::string& message, bool json) {
  return refused(Error{ErrorCode::kBadInput, std::string_view(message), {}}, json, kUsage);
}

/// The tasks among `tasks` that are not ON yet.
std::vector<std::string> still_off(Session& session, std::vector<std::string> tasks) {
  const control::RpcResponse status = session.ask("status");
  if (!status.is_good()) return tasks;
  for (const Json& task : (*status.result)["tasks"])
    if (text_of(task, "state") == "ON") std::erase(tasks, text_of(task, "task"));
  return tasks;
}

/// A configuration stands for those of its tasks that are not ON, unless a task has that name.
std::vector<std::string> with_configuration(Session& session, std::vector<std::string> tasks) {
  const control::RpcResponse described = session.ask("describe");
  if (tasks.size() != 1 || !described.is_good()) return tasks;
  const Names names = names_of(*described.result);
  if (std::find(names.tasks.begin(), names.tasks.end(), tasks[0]) != names.tasks.end()) return tasks;
  for (const Json& set : (*described.result)["configurations"])
    if (text_of(set, "name") == tasks[0]) return still_off(session, texts_of(set, "tasks"));
  return tasks;
}

/// The number of one process, and nothing else: for `kill`.
CommandResult pid(Session& session, const Call& call) {
  const std::string name = call.value("--pid");
  const control::RpcResponse hello = session.ask("hello"), status = session.ask("status");
  for (const control::RpcResponse* asked : {&hello, &status})
    if (!asked->is_good()) return refused(*asked, call.json);
  std::map<std::string, std::int64_t> pids = {{"keeper", whole_of(*hello.result, "keeper_pid")},
                                              {"manager", whole_of((*hello.result)["manager"], "pid")}};
  for (const Json& rtpu : (*status.result)["rtpus"])
    pids[text_of(rtpu, "name")] = truth_at(rtpu, "alive") ? whole_of(rtpu, "pid") : 0;
  const auto found = pids.find(name);
  if (found != pids.end() && found->second > 0)
    return {call.json ? json_line({{"name", name}, {"pid", found->second}})
                      : std::to_string(found->second) + "\n", "", kOk};
  const auto names = chimera::names_of(pids, [](const auto& pid) { return pid.first; });
  const std::string why = found != pids.end() ? "the process of '" + name + "' is dead" : no_such("rtpu", name, names);
  return refused(Error{ErrorCode::kNotFound, {"--pid: " + why}, {}}, call.json);
}

/// `parameters` with the option --wait of the call.
Result<Json> with_wait(const Call& call, Json parameters) {
  if (!call.has("--wait")) return parameters;
  const auto wait = parse_duration(call.value("--wait"));
  const bool is_right = wait && *wait >= milliseconds(1) && *wait <= seconds(600);
  const std::string why = wait ? "write 1 ms to 10 min" : std::string(wait.error().message.view());
  if (!is_right) return (Message() << "--wait: " << why).error(ErrorCode::kBadInput, {});
  parameters["wait_ms"] = wait->count / 1'000'000;
  return parameters;
}

/// Asks on the terminal. False without a terminal, and for every answer but "yes".
bool has_agreed(const std::string& question) {
  if (!is_terminal(kStandardInput)) return false;
  std::fprintf(stderr, "%s [yes/no] ", plain_line(question).c_str());
  std::string typed;
  while (typed.find_first_of("\r\n") == std::string::npos && read_keys(typed)) continue;
  return typed.substr(0, typed.find_first_of("\r\n")) == "yes";
}

}  // namespace

CommandResult turn_on(Session& session, const Call& call, const Screen&) {
  const std::vector<std::string> tasks = with_configuration(session, call.operands);
  if (tasks.empty()) return {call.json ? "{\"tasks\":[]}\n" : "all of its tasks are ON\n", "", kOk};
  return answered(session.ask("signal", {{"signal", "on"}, {"tasks", tasks}}), call.json, signal_text);
}

CommandResult profile(Session& session, const Call& call, const Screen&) {
  const control::RpcResponse answer = session.ask("profile");
  if (!call.has("--save")) return answered(answer, call.json, profile_text);
  const control::RpcResponse hello = session.ask("hello");
  for (const control::RpcResponse* asked : {&answer, &hello})
    if (!asked->is_good()) return refused(*asked, call.json);
  const auto tasks = read_profiles((*answer.result)["tasks"], Nanoseconds{});
  if (!tasks) return refused(tasks.error(), call.json);
  const std::string file = call.value("--save");
  const auto written = write_recorded_profile(file, recorded(text_of(*hello.result, "subsystem"), *tasks));
  if (!written) return refused(written.error(), call.json);
  return {call.json ? json_line({{"file", file}}) : file + ": written\n", "", kOk};
}

CommandResult flag(Session& session, const Call& call, const Screen&) {
  if (call.operands[0] != "up" && call.operands[0] != "down")
    return wrong("flag: found '" + call.operands[0] + "', expected up or down", call.json);
  return answered(session.ask("flag", {{"up", call.operands[0] == "up"}}), call.json, flag_text);
}

CommandResult status(Session& session, const Call& call, const Screen&) {
  if (call.has("--pid")) return pid(session, call);
  return answered(session.ask("status"), call.json, status_text);
}

CommandResult save(Session& session, const Call& call, const Screen&) {
  return call.has("--write") ? save_to_file(session, call) : answered(session.ask("save"), call.json, save_text);
}

CommandResult switch_to(Session& session, const Call& call, const Screen&) {
  const bool is_cancel = call.has("--cancel"), is_dry = call.has("--dry-run");
  Json asked = Json::object();
  if (!call.operands.empty()) asked["configuration"] = call.operands[0];
  if (call.has("--on")) asked["on"] = call.values("--on");
  if (call.has("--off")) asked["off"] = call.values("--off");
  if (is_cancel != asked.empty() || (is_cancel && (is_dry || call.has("--wait"))))
    return wrong("switch: name a configuration, or tasks with --on and --off, or give --cancel alone", call.json);
  if (is_dry) return answered(session.ask("plan", asked), call.json, plan_text);
  const auto parameters = with_wait(call, std::move(asked));
  if (!parameters) return refused(parameters.error(), call.json, kUsage);
  const control::RpcResponse answer = session.ask(is_cancel ? "cancel" : "switch", *parameters);
  CommandResult result = answered(answer, call.json, switch_text);
  if (answer.is_good() && text_of(*answer.result, "end") == "aborted" && !is_cancel) result.code = kRefused;
  return result;
}

CommandResult drill(Session& session, const Call& call, const Screen&) {
  auto parameters = with_wait(call, Json::object());
  if (!parameters) return refused(parameters.error(), call.json, kUsage);
  if (call.has("--kill")) (*parameters)["kill"] = call.value("--kill");
  if (!call.has("--yes") && !has_agreed("the drill raises the flag of '" + session.subsystem() +
                                        "': every device goes to its safe state" +
                                        (call.has("--kill") ? ", then " + call.value("--kill") + " is killed" : "") +
                                        ". Go on?"))
    return wrong("drill: not agreed to; `--yes` does not ask", call.json);
  const control::RpcResponse answer = session.ask("drill", *parameters);
  CommandResult result = answered(answer, call.json, drill_text);
  if (answer.is_good() && !truth_at(*answer.result, "safe")) result.code = kRefused;
  return result;
}

CommandResult why(Session& session, const Call& call, const Screen& screen) {
  return answered(session.ask("why", {{"variable", call.operands[0]}}), call.json,
                  [&](const Json& answer) { return why_text(answer, screen.height); });
}

CommandResult end(Session& session, const Call& call, const Screen&) {
  control::RpcResponse answer = session.ask("end", {{"code", 0}});
  if (answer.code == control::kNoConnection)
    answer = control::RpcResponse::good(Json::object());  // it has ended already
  return answered(answer, call.json, [](const Json&) { return std::string("ending\n"); });
}

}  // namespace chimera::cli
