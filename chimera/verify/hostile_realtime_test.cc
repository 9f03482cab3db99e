// SPDX-License-Identifier: Apache-2.0
// A hostile description is refused within 64 MiB. Each measurement in a release build has its own process, because the
// memory of a process never shrinks. The time is only recorded; the goal is 100 ms.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "chimera/base/testing/await.h"
#include "chimera/catalogue/library.h"
#include "chimera/platform/clock.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

std::string repeated(std::string_view part, std::size_t bytes) {
  std::string out;
  while (out.size() + part.size() <= bytes) out += part;
  return out;
}

struct Hostile {
  const char* name;
  std::string text;
};

std::vector<Hostile> hostile() {
  constexpr std::size_t kFull = 256 * 1024 - 64;
  const std::string head = "subsystem: demo\ntasks: ";
  std::string laughs = "a: &a [lol, lol]\n";
  for (char c = 'b'; c < 'z'; ++c)
    laughs += std::string(1, c) + ": &" + c + " [*" + char(c - 1) + ", *" + char(c - 1) + "]\n";
  std::string keys = "subsystem: demo\ntasks:\n";
  for (int i = 0; i < 8000; ++i) keys += "  t" + std::to_string(i) + ": {x: 1}\n";
  std::string staircase;
  for (int i = 0; i < 700; ++i) staircase += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  return {{"lists", head + repeated("[", 32000)},
          {"lists_beyond", head + repeated("[", kFull)},
          {"lists_in_quotes", head + "\"" + repeated("[", kFull) + "\""},
          {"maps", head + repeated("{a: ", kFull)},
          {"maps_few", head + repeated("{a: ", 60000)},
          {"sequences", head + repeated("- ", 60000)},
          {"complex_keys", repeated("? ", 60000)},
          {"staircase", staircase},
          {"huge_number", head + "{a: {rate: " + repeated("9", kFull) + " Hz}}"},
          {"huge_key", head + "{" + repeated("k", kFull) + ": 1}"},
          {"ten_megabytes", repeated("tasks: {a: 1}\n", 10 << 20)},
          {"bad_utf8", head + repeated("\xff\xfe", kFull)},
          {"laughs", laughs},
          {"many_tasks", keys},
          {"many_values", head + "{a: {constants: {b: [" + repeated("1,", 60000) + "]}}}"},
          {"one_key_again", repeated("a: 1\n", 80000)},
          {"unclosed_quote", head + "\"" + repeated("x ", kFull)},
          {"colons", repeated(":", 30000)},
          {"anchors", head + "[" + repeated("&a b, ", 90000) + "]"},
          {"tags", head + "[" + repeated("!!str b, ", 90000) + "]"},
          {"documents", repeated("---\n", 100000)},
          {"percent", repeated("%TAG ! !\n", 100000)},
          {"zeroes", std::string(200000, '\0')}};
}

struct Cost {
  Nanoseconds time;
  long kilobytes = 0;
  bool refused = false;
};

/// Reads the file in a child and returns the cost. The time to start the child does not count; its memory does.
Cost cost_of(const std::string& path, const Library& library) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    LinuxClock clock;
    const Nanoseconds start = clock.now();
    const Verdict verdict = verify(read_description_file(path), library);
    const std::string text = verdict.report.text() + verdict.report.json();
    const Cost cost{clock.now() - start, static_cast<long>(text.size() / 1024), !verdict.configuration};
    const bool sent = ::write(ends[1], &cost, sizeof cost) == sizeof cost;
    ::_exit(sent ? 0 : 1);
  }
  Cost cost;
  int status = 0;
  struct rusage usage {};
  EXPECT_EQ(::read(ends[0], &cost, sizeof cost), static_cast<ssize_t>(sizeof cost));
  ::wait4(child, &status, 0, &usage);
  ::close(ends[0]);
  ::close(ends[1]);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  cost.kilobytes = usage.ru_maxrss;
  return cost;
}

TEST(HostileDescription, IsRefusedWithin64Mebibytes) {
  const Library library = Library::of({}, our_units());
  const std::string path = testing::TempDir() + "hostile_" + std::to_string(::getpid()) + ".yaml";
  for (const Hostile& each : hostile()) {
    std::ofstream(path, std::ios::binary) << each.text;
    const Cost cost = cost_of(path, library);
    EXPECT_TRUE(cost.refused) << each.name;
    EXPECT_LE(cost.kilobytes, 64 * 1024) << each.name;
    record_duration(each.name, cost.time);
  }
  ::unlink(path.c_str());
}

}  // namespace
}  // namespace chimera
