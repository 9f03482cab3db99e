// SPDX-License-Identifier: Apache-2.0
// The server of the page: chimera-web [--json] [--port N] [FILE], started by `chimera web`, which judges the words.
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <new>
#include <string_view>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/control/running.h"
#include "chimera/control/state_folder.h"
#include "chimera/platform/socket_place.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/web/web_server.h"

namespace {

using namespace chimera;  // NOLINT: a main() of this project

constexpr std::string_view kNoMemory = "chimera-web: out of memory\n";

void tell(const std::string& sentence) { std::fprintf(stderr, "chimera-web: %s\n", plain_line(sentence).c_str()); }

int serve(const web::WebRequest& request, bool json) {
  auto page = web::read_page(program_path());
  if (!page) return tell(std::string(page.error().where.view()) + ": " + page.error().message.c_str()), 1;
  auto server = web::WebServer::open(request, *std::move(page), tell);
  if (!server) return tell(server.error().message.c_str()), 1;
  const std::string& link = (*server)->link();
  std::printf("%s\n", (json ? "{\"url\": \"" + link + "\"}" : link).c_str());
  (void)flush_and_look(stdout);  // without a reader the page is served all the same
  (*server)->run();
  ::_exit(0);  // while signals are still caught: a second Ctrl-C during the end changes nothing
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  std::set_new_handler([] {
    (void)!::write(STDERR_FILENO, kNoMemory.data(), kNoMemory.size());
    ::_exit(1);
  });
  bool json = false;
  const std::string program = program_path(), state = control::state_folder();
  web::WebRequest request{{}, {.program = CHIMERA_VERSION,
                               .file = "",
                               .own_folder = std::string(socket_folder().view()),
                               .service_folder = control::kServiceFolder,
                               .programs = program.substr(0, program.rfind('/')),
                               .drafts = state.empty() ? "" : state + "/drafts",
                               .workplace = Workplace::around(program)}};
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--json") {
      json = true;
    } else if (word == "--port" && i + 1 < argc) {
      const std::string_view text = argv[++i];
      std::uint16_t port = 0;
      std::from_chars(text.data(), text.data() + text.size(), port);
      request.port = port;
    } else if (word.starts_with("-")) {
      tell("is started by `chimera web`, with [--json] [--port N] [FILE]; `chimera web --help` says more");
      return 2;
    } else {
      request.facts.file = absolute_path(std::string(word));
    }
  }
  return serve(request, json);
}
