// SPDX-License-Identifier: Apache-2.0
// Finds the subsystem of a command and hands the command to what carries it out.
#include "chimera/shell/carry_out.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "chimera/shell/live.h"
#include "chimera/shell/one_shot.h"
#include "chimera/shell/save_file.h"
#include "chimera/shell/scope_command.h"
#include "chimera/shell/terminal.h"

namespace chimera::shell {

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
  return answer.dump() + "\n";
}

/// An act and its refusal tell whom they reached.
Said named(Said said, Session& session, const Call& call) {
  if (call.json) return said.out = with_subsystem(said.out, session.subsystem()), said;
  if (!call.is_act() || call.has("--pid")) return said;
  said.out = behind_name(said.out, session.subsystem());
  said.err = behind_name(said.err, session.subsystem());
  return said;
}

}  // namespace

int carry_out(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  if (call.is_act())
    if (const auto may = session.may_act(); !may) return print(refused(may.error(), call.json), out, err);
  (void)session.subsystem();  // known before the act: after an `end` nobody can be asked
  if (is_live(call)) return live(session, call, out, err);
  const std::size_t width = is_terminal(kStandardOutput) ? screen_size(kStandardOutput).width : 0;
  Said said = std::string_view(call.command->name) == "scope" ? scope(session, call, width, err)
              : call.has("--write")                           ? save_to_file(session, call)
                                    : one_shot(session, call, {.height = screen_size(kStandardOutput).height});
  return print(named(std::move(said), session, call), out, err);
}

int carry_out(const Surroundings& surroundings, const Call& call, std::FILE* out, std::FILE* err) {
  Surroundings known = surroundings;
  known.command = command_line(call);
  auto session = Session::open(known);
  if (!session) return print(refused(session.error(), call.json), out, err);
  // Whoever does not answer now will not answer the command either: one limit, not one for each question of it.
  if (const control::Answer hello = session->hear(); !hello.is_good())
    return print(refused(hello, call.json), out, err);
  // Who did not say which one learns which one it is; status and top head with it, an act says it in every line.
  const std::string_view name = call.command->name;
  const bool says_itself = call.json || call.is_act() || name == "status" || name == "top";
  if (!session->is_named() && !says_itself) std::fprintf(err, "[%s]\n", session->subsystem().c_str());
  return carry_out(*session, call, out, err);
}

}  // namespace chimera::shell
