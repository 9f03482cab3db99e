// SPDX-License-Identifier: Apache-2.0
// The manager of a subsystem, started by its keeper: chimera-manager --peer N --incarnation I --parent PID; and its
// analyst, started by the manager: chimera-manager --analyst --parent PID.
#include <sys/prctl.h>
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <string_view>

#include "chimera/manager/answer/analyst.h"
#include "chimera/manager/answer/question.h"
#include "chimera/manager/run.h"
#include "chimera/platform/process.h"

namespace {

constexpr std::string_view kNoMemory = "chimera-manager: out of memory\n";

/// The number behind `word`; 0 when it is not there or is none.
std::int32_t number_after(std::string_view word, int argc, char** argv) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (argv[i] != word) continue;
    std::int32_t number = 0;
    const char* end = argv[i + 1] + std::strlen(argv[i + 1]);
    return std::from_chars(argv[i + 1], end, number).ptr == end ? number : 0;
  }
  return 0;
}

int analyst(std::int32_t parent) {
  using namespace chimera;  // NOLINT: as in main()
  ::prctl(PR_SET_NAME, "chimera-analyst");
  if (!follow_parent(parent, SIGKILL)) return 0;
  run_in_background(manager::kAnalystMemory);
  const auto ran = manager::run_analyst(manager::kAnalystDescriptors[0], manager::kAnalystDescriptors[1]);
  if (ran) return *ran;
  std::fprintf(stderr, "chimera-manager: the analyst: %s\n", ran.error().message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace chimera;  // NOLINT: a main() of this project
  const std::int32_t parent = number_after("--parent", argc, argv);
  if (argc == 4 && std::strcmp(argv[1], "--analyst") == 0 && parent > 0) return analyst(parent);
  const std::int32_t incarnation = number_after("--incarnation", argc, argv);
  if (parent <= 0 || incarnation <= 0) {
    std::fputs("chimera-manager is started by `chimera run`, with --peer N --incarnation I --parent PID\n", stderr);
    return 2;
  }
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  if (!follow_parent(parent, SIGTERM)) return 0;
  std::set_new_handler([] {  // the keeper starts another one
    (void)!::write(STDERR_FILENO, kNoMemory.data(), kNoMemory.size());
    ::_exit(1);
  });
  const auto ran = manager::run({}, static_cast<std::uint32_t>(incarnation), parent);
  if (ran) return *ran;
  std::fprintf(stderr, "chimera-manager: %s\n", ran.error().message.c_str());
  return 1;
}
