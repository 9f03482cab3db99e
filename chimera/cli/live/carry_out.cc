// SPDX-License-Identifier: Apache-2.0
// Carries out a call by its row, and names the subsystem that an act reached.
#include "chimera/cli/live/carry_out.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "chimera/cli/live/answer_text.h"
#include "chimera/cli/live/terminal.h"

namespace chimera::cli {

namespace {

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
  nlohmann::json answer = nlohmann::json::parse(text, nullptr, false);
  if (!answer.is_object()) return text;
  answer["subsystem"] = subsystem;
  return json_line(answer);
}

/// An act and its refusal tell whom they reached.
CommandResult named(CommandResult said, Session& session, const Call& call) {
  if (call.json) return said.out = with_subsystem(said.out, session.subsystem()), said;
  if (!call.is_act() || row_of(call).names_its_subsystem) return said;
  said.out = behind_name(said.out, session.subsystem());
  said.err = behind_name(said.err, session.subsystem());
  return said;
}

}  // namespace

int carry_out(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  if (call.is_act())
    if (const auto may = session.may_act(); !may) return print(refused(may.error(), call.json), out, err);
  (void)session.subsystem();  // known before the act: after an `end` nobody can be asked
  const RunningCommand& row = row_of(call);
  if (row.is_live(call)) return row.live(session, call, out, err);
  const ScreenSize size = screen_size(kStandardOutput);
  const Screen screen{is_terminal(kStandardOutput) ? size.width : 0, size.height, err};
  CommandResult said = one_shot(session, call, screen);
  return print(named(std::move(said), session, call), out, err);
}

int carry_out(const Surroundings& surroundings, const Call& call, std::FILE* out, std::FILE* err) {
  Surroundings known = surroundings;
  known.command = command_line(call);
  auto session = Session::open(known);
  if (!session) return print(refused(session.error(), call.json), out, err);
  // Whoever does not answer now will not answer the command either: one limit, not one for each question of it.
  if (const control::RpcResponse hello = session->hello(); !hello.is_good())
    return print(refused(hello, call.json), out, err);
  // Who did not say which one learns which one it is; status and top head with it, an act says it in every line.
  const bool says_itself = call.json || call.is_act() || row_of(call).names_its_subsystem;
  if (!session->is_named() && !says_itself) std::fprintf(err, "[%s]\n", session->subsystem().c_str());
  return carry_out(*session, call, out, err);
}

}  // namespace chimera::cli
