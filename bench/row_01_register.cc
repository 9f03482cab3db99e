// SPDX-License-Identifier: Apache-2.0
// Row 1: reading and writing a group as a task does, beside libc memcpy of the same values. The register moves a header
// of 32 bytes more, and decides whether what it read is whole.
#include <cstring>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "chimera/table/group.h"

namespace chimera {
namespace {

struct alignas(kCacheLine) Line {
  std::byte b[kCacheLine]{};
};

std::vector<Line> lines_for(std::size_t bytes) { return std::vector<Line>(bytes / kCacheLine + 1); }
std::byte* first(std::vector<Line>& lines) { return lines[0].b; }

struct Goals {
  std::uint32_t payload;
  double read, write;
};

void compare(const Goals& goals, int repetitions) {
  const std::uint32_t payload = goals.payload;
  auto memory = lines_for(group_bytes(payload)), target = lines_for(slot_stride(payload)), source = lines_for(payload);
  GroupWriter writer({first(memory), group_bytes(payload)}, payload);
  const GroupReader reader(first(memory), payload);
  writer.write(first(source), Nanoseconds{1}, 1);
  auto* const slot = reinterpret_cast<chimera_slot*>(first(target));  // header and values, as LocalGroup has them
  std::uint64_t refused = 0;

  const auto copy = [&](std::uint64_t n) {
    while (n--) {
      std::size_t size = payload;
      asm volatile("" : "+r"(size));  // as in the register: a call of memcpy, not `rep movsq`
      std::memcpy(first(target), first(source), size);
      bench::keep(*first(target));
    }
  };
  const auto read = [&](std::uint64_t n) {
    while (n--) {
      if (!reader.try_read(slot)) ++refused;
      bench::keep(*first(target));
    }
  };
  // Both writers publish values of which one was just computed, as a task does.
  const auto compute = [&](std::uint64_t k) { std::memcpy(first(source), &k, sizeof k); };
  const auto write = [&](std::uint64_t n) {
    while (n--) {
      compute(n);
      writer.write(first(source), Nanoseconds{1}, 1);
      bench::keep(*first(memory));
    }
  };
  const auto copy_round = [&](std::uint64_t n) {  // what a writer must do at least: four places in turn
    const std::size_t stride = slot_stride(payload);
    for (std::uint64_t k = 0; k < n; ++k) {
      compute(k);
      std::size_t size = payload;
      asm volatile("" : "+r"(size));
      std::memcpy(first(memory) + kCacheLine + (k % kSlots) * stride + sizeof(chimera_slot), first(source), size);
      bench::keep(*first(memory));
    }
  };

  bench::Comparison reads(repetitions);
  const auto raw = reads.add("memcpy", copy);
  const auto ours = reads.add("register", read);
  reads.run(raw);
  const std::string size = std::to_string(payload) + " B";
  bench::print(bench::Figure{.row = 1, .what = "read " + size, .goal = bench::ratio_at_most(goals.read)}
                   .of(reads, ours));
  bench::Comparison writes(repetitions);
  const auto raw_write = writes.add("memcpy, 4 places", copy_round);
  const auto our_write = writes.add("register", write);
  writes.run(raw_write);
  bench::print(bench::Figure{.row = 1, .what = "write " + size, .goal = bench::ratio_at_most(goals.write)}
                   .of(writes, our_write));
  if (refused != 0) std::exit(1);
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  const chimera::bench::Stage stage;
  for (const chimera::Goals& goals : {chimera::Goals{80, 1.5, 1.1}, {512, 1.2, 1.1}, {4096, 1.1, 1.1}})
    chimera::compare(goals, chimera::bench::repetitions(argc, argv));
}
