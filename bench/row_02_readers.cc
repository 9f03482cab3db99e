// SPDX-License-Identifier: Apache-2.0
// Row 2: readers store nothing, so a second one costs the first nothing; and they need a read-only mapping only.
// The second reader runs at normal priority on the other CPU; on a machine with one CPU the row is not measured.
#include <atomic>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/bench.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/table/group.h"

namespace chimera {
namespace {

void measure(std::uint32_t payload, int repetitions) {
  Result<MemoryRegion> owner = MemoryRegion::create("bench", group_bytes(payload));
  if (!owner) std::exit(1);
  const Result<MemoryRegion> mapping = MemoryRegion::open_read_only(owner->descriptor(), group_bytes(payload));
  if (!mapping) std::exit(1);
  GroupWriter(owner->writable(), payload).publish(Nanoseconds{1}, 1);
  const GroupReader reader(mapping->bytes().data(), payload);
  std::vector<std::byte> target(payload);
  const auto read = [&](std::uint64_t n) {
    chimera_slot header{};
    while (n--) {
      if (!reader.try_read(header, target.data())) std::exit(1);
      bench::keep(*target.data());
    }
  };
  std::atomic<bool> stop{false}, pause{true};
  bench::Beside second(0, [&] {
    std::vector<std::byte> other(payload);
    chimera_slot header{};
    while (!stop.load(std::memory_order_relaxed)) {
      if (pause.load(std::memory_order_relaxed)) {
        std::this_thread::yield();
        continue;
      }
      for (int i = 0; i < 100; ++i)
        if (!reader.try_read(header, other.data())) std::exit(1);
    }
  });
  bench::Comparison comparison(repetitions);
  const auto alone = comparison.add("1 reader", [&](std::uint64_t n) {
    pause = true;
    read(n);
  });
  const auto both = comparison.add("2 readers", [&](std::uint64_t n) {
    pause = false;
    read(n);
  });
  comparison.run(alone);
  stop = true;
  bench::print(bench::Figure{.row = 2,
                             .what = "read " + std::to_string(payload) + " B beside a second reader, read-only mapping",
                             .goal = bench::ratio_at_most(1.15)}
                   .of(comparison, both));
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  if (std::thread::hardware_concurrency() < 2) {
    std::fprintf(stderr, "row 2 needs two CPUs\n");
    return 1;
  }
  const chimera::bench::Stage stage;
  for (const std::uint32_t payload : {80u, 512u, 4096u})
    chimera::measure(payload, chimera::bench::repetitions(argc, argv));
}
