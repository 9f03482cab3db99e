// SPDX-License-Identifier: Apache-2.0
// `chimera web`: replaces this process by chimera-web, which serves the page.
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "apps/chimera/commands.h"
#include "apps/chimera/option_values.h"
#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/cli/files/file_refusal.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Call;
using cli::WordKind;

namespace {

int web(const Call& call, const Workplace&) {
  const std::string file = call.operand(0);
  const auto refuse = [&](const std::string& why, const std::string& where) {
    return print(cli::file_refusal(Message(why).error(ErrorCode::kRefused, where), call.json));
  };
  if (!file.empty())
    if (const std::string why = not_ordinary(file, static_cast<std::size_t>(-1)); !why.empty())
      return refuse(why, file);
  const std::string own = program_path();
  std::vector<std::string> words = {own.substr(0, own.rfind('/') + 1) + "chimera-web"};
  if (call.json) words.push_back("--json");
  if (call.has("--port")) words.insert(words.end(), {"--port", call.value("--port")});
  if (!file.empty()) words.push_back(absolute_path(file));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  return refuse(errno == ENOENT ? "is not there: this program was built without libboost-dev, esbuild, node-react or "
                                  "node-react-dom; `./dev install` builds it with them"
                                : "cannot be started: " + std::string(std::strerror(errno)),
                words[0]);
}

}  // namespace

FileCommand web_row() {
  return {.words = {.name = "web",
                    .help = "Serve a page that shows what runs, to a browser on this machine",
                    .operands = "[FILE]",
                    .most = 1,
                    .operand_kind = WordKind::kDescription,
                    .operand_help = "a description: the page shows the subsystem that runs it first",
                    .options = {{.name = "--port",
                                 .value = "N",
                                 .help = "this port (7440, or the next free one up to 7449); 0: any free one",
                                 .kind = WordKind::kNumber,
                                 .most = 65535}},
                    .json = "the link as one JSON object",
                    .footer = "Open the link that it prints; Ctrl-C ends the page, not the subsystems.",
                    .example = "chimera web arm.yaml",
                    .manual =
                        "Prints the link of a page that shows the running subsystems of this user and of "
                        "/run/chimera: picture, states, values. The page shows first the subsystem that runs "
                        "FILE, which need not exist. The link holds a key, new at each start, with which "
                        "a browser acts as this user. Only programs of this machine reach the port; from another one: "
                        "`ssh -L 7440:127.0.0.1:7440 HOST`.",
                    .outlives_reader = true},
          .carry_out = web};
}
