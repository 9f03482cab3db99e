// SPDX-License-Identifier: Apache-2.0
// The process that writes safe frames; started by the keeper only. It ends when the keeper is gone and no rtpu lives
// any more.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "chimera/guard/guard.h"
#include "chimera/platform/realtime.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/runtime/hosted/pages.h"

namespace {

using namespace chimera;  // NOLINT: a main() of this project

constexpr int kHighest = 99;
constexpr Nanoseconds kBeatEvery = milliseconds(250);

/// "--silent TASK:PERIODS", as often as there are such tasks. Empty where one is no such pair, too: create() refuses.
std::vector<SilenceLimit> limits_of(int argc, char** argv) {
  std::vector<SilenceLimit> limits;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--silent") != 0) continue;
    char* end = nullptr;
    const auto task = static_cast<std::uint32_t>(std::strtoul(argv[i + 1], &end, 10));
    const unsigned long periods = *end == ':' ? std::strtoul(end + 1, nullptr, 10) : 0;
    limits.push_back({TaskId(task), static_cast<std::uint32_t>(periods)});
  }
  return limits;
}

Result<void> guard(int argc, char** argv) {
  const auto bytes = FrozenBytes::open(kGuardImageDescriptor);
  if (!bytes) return bytes.error();
  const auto image = ApplicationImage::decode(bytes->bytes());
  if (!image) return image.error();
  const auto decision = SharedPages::open(kGuardDecisionDescriptor, sizeof(DecisionPage));
  if (!decision) return decision.error();
  std::atomic<std::uint64_t>& beats = reinterpret_cast<DecisionPage*>(decision->bytes().data())->guard_beats;
  const auto made = Guard::create(Channel(kGuardChannelDescriptor), *image, limits_of(argc, argv));
  if (!made) return made.error();
  // Above all bands, which are counted down from the priority of the run.
  const int top = image->settings().priority;
  const int priority = top == 0 ? 0 : std::min(top + 1, kHighest);
  const RealtimeGrant grant = enter_realtime({.priority = priority, .room = (*made)->room()});
  (*made)->say_ready(top == 0 || grant.is_complete());
  do beats.fetch_add(1, std::memory_order_relaxed);
  while ((*made)->step(kBeatEvery));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || std::strcmp(argv[1], "--parent") != 0) {
    std::fputs("chimera-guard is started by `chimera run`\n", stderr);
    return 2;
  }
  std::signal(SIGTERM, SIG_IGN);  // NOLINT: a service manager sends it to all; the guard ends after the last rtpu
  const auto ended = guard(argc, argv);
  if (ended) return 0;
  std::fprintf(stderr, "chimera-guard: %s\n", ended.error().message.c_str());
  return 1;
}
