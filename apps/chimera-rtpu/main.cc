// SPDX-License-Identifier: Apache-2.0
// The process of an rtpu; started by the keeper only. Knows no YAML, JSON or HTTP.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <system_error>

#include "chimera/rtpu/keeper_message.h"
#include "chimera/rtpu/rtpu.h"

namespace {

// The number behind `--name` in the arguments; -1: not there.
long number(int argc, char** argv, const char* name) {
  for (int i = 1; i + 1 < argc; i += 2)
    if (std::strcmp(argv[i], name) == 0) return std::strtol(argv[i + 1], nullptr, 10);
  return -1;
}

}  // namespace

int main(int argc, char** argv) {
  const long peer = number(argc, argv, "--peer"), incarnation = number(argc, argv, "--incarnation");
  const long parent = number(argc, argv, "--parent");
  if (peer < 0 || incarnation <= 0 || parent <= 0) {
    std::fputs("chimera-rtpu is started by `chimera run`\n", stderr);
    return 2;
  }
  chimera::RtpuStart start;
  start.peer = static_cast<std::uint32_t>(peer);
  start.incarnation = static_cast<std::uint32_t>(incarnation);
  start.parent = static_cast<pid_t>(parent);
  start.channel = chimera::kChannelDescriptor;
  start.image = chimera::kImageDescriptor;
  start.decision_page = chimera::kDecisionPageDescriptor;
  start.keeper_page = chimera::kKeeperPageDescriptor;
  start.objects = chimera::kObjectsDescriptor;
  start.guard = static_cast<int>(number(argc, argv, "--guard"));
  int code = 1;
  try {
    code = chimera::run_rtpu(start);
  } catch (const std::system_error& error) {
    std::fprintf(stderr, "chimera-rtpu: no thread: %s\n", error.code().message().c_str());
  } catch (const std::bad_alloc&) {
    std::fputs("chimera-rtpu: out of memory\n", stderr);
  }
  ::_exit(code);  // static destructors of components are not run: they may be in any state
}
