// SPDX-License-Identifier: Apache-2.0
#include "chimera/shell/carry_out.h"

#include <unistd.h>

#include "chimera/shell/live.h"
#include "chimera/shell/one_shot.h"
#include "chimera/shell/save_file.h"
#include "chimera/shell/scope_command.h"
#include "chimera/shell/terminal.h"

namespace chimera::shell {

int carry_out(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  if (std::string_view(call.command->name) == "scope") {
    const std::size_t width = is_terminal(STDOUT_FILENO) ? screen_size(STDOUT_FILENO).width : 0;
    return print(scope(session, call, width), out, err);
  }
  if (call.has("--write")) return print(save_to_file(session, call), out, err);
  if (is_live(call)) return live(session, call, out, err);
  return print(one_shot(session, call, {.height = screen_size(STDOUT_FILENO).height}), out, err);
}

int carry_out(const Surroundings& surroundings, const Call& call, std::FILE* out, std::FILE* err) {
  auto session = Session::open(surroundings);
  if (!session) return print(refused(session.error(), call.json), out, err);
  return carry_out(*session, call, out, err);
}

}  // namespace chimera::shell
