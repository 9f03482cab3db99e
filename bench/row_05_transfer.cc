// SPDX-License-Identifier: Apache-2.0
// Row 5: the whole transfer of a task in one cycle - three foreign groups in, its own out, 80 B each - beside the same
// four copies alone. And the figure of the 1994 paper (section 3.1), beside the context switch of this machine: a
// transfer of 10 elements takes less than 5 us where a context switch takes 100 us, a twentieth of it.
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

#include "bench/bench.h"
#include "chimera/table/transfer.h"

namespace chimera {
namespace {

constexpr std::uint32_t kPayload = 80;
constexpr std::size_t kInputs = 3;

struct alignas(kCacheLine) Group {
  std::byte bytes[group_bytes(kPayload)]{};
};
struct alignas(kCacheLine) Local {
  std::byte bytes[local_group_bytes(kPayload)]{};
};
struct alignas(kCacheLine) Values {
  std::byte bytes[kPayload]{};
};

void copy(void* to, const void* from) {
  std::size_t size = kPayload;
  asm volatile("" : "+r"(size));
  std::memcpy(to, from, size);
}

// Hands the processor to a thread of the same CPU and gets it back: two context switches, each with the write and the
// read that cause it.
class Switches {
 public:
  Switches() : there_(eventfd(0, 0)), back_(eventfd(0, 0)), other_(sched_getcpu(), [this] { answer(); }) {}
  ~Switches() {
    ends_ = true;
    switch_twice();
  }
  void switch_twice() {
    ring(there_);
    await(back_);
  }

 private:
  static void ring(int descriptor) {
    const std::uint64_t one = 1;
    if (write(descriptor, &one, sizeof one) != sizeof one) std::exit(1);
  }
  static void await(int descriptor) {
    std::uint64_t count;
    if (read(descriptor, &count, sizeof count) != sizeof count) std::exit(1);
  }
  void answer() {
    for (bool ends = false; !ends;) {
      await(there_);
      ends = ends_;  // written before the last ring
      ring(back_);
    }
  }

  int there_, back_;
  std::atomic<bool> ends_{false};
  bench::Beside other_;
};

// One variable of 10 float64 from its producer to a task, and one from the task to the table.
void print_ten_elements(int repetitions) {
  static Group in, own;
  static Local memory;
  static Values mine;
  GroupWriter(in.bytes, kPayload).publish(Nanoseconds{1}, 1);
  LocalGroup local(GroupReader(in.bytes, kPayload), memory.bytes);
  GroupWriter writer(own.bytes, kPayload);
  Switches switches;
  bench::Comparison comparison(repetitions);
  const auto one_switch = comparison.add("a context switch on the same CPU", [&](std::uint64_t n) {
    for (std::uint64_t i = 0; i < n; i += 2) switches.switch_twice();
  });
  const auto transfer = comparison.add("transfer", [&](std::uint64_t n) {
    while (n--) {
      if (!local.refresh()) std::exit(1);
      bench::keep(memory);
      std::memcpy(mine.bytes, &n, sizeof n);
      writer.write(mine.bytes, Nanoseconds{1}, 1);
      bench::keep(own);
    }
  });
  comparison.run(one_switch);
  bench::print(bench::Figure{.row = 5, .what = "10 elements in and 10 out (paper: 5 us each way)",
                             .goal = bench::ratio_at_most(0.05)}
                   .of(comparison, transfer));
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  using namespace chimera;
  const bench::Stage stage;
  static Group groups[kInputs], own;
  static Local locals[kInputs];
  static Values shared[kInputs + 1], mine[kInputs + 1];
  LocalGroup local[kInputs];
  GroupInput inputs[kInputs];
  for (std::size_t i = 0; i < kInputs; ++i) {
    GroupWriter(groups[i].bytes, kPayload).publish(Nanoseconds{1}, 1);
    local[i] = LocalGroup(GroupReader(groups[i].bytes, kPayload), locals[i].bytes);
    inputs[i] = GroupInput::copied(local[i]);
  }
  GroupWriter writer(own.bytes, kPayload);
  std::uint64_t stale = 0;
  bench::Comparison comparison(bench::repetitions(argc, argv));
  const auto raw = comparison.add("4 memcpy", [&](std::uint64_t n) {
    while (n--) {
      for (std::size_t i = 0; i < kInputs; ++i) copy(mine[i].bytes, shared[i].bytes);
      bench::keep(mine);
      std::memcpy(mine[kInputs].bytes, &n, sizeof n);  // the task computes an output
      copy(shared[kInputs].bytes, mine[kInputs].bytes);
      bench::keep(shared);
    }
  });
  const auto ours = comparison.add("transfer", [&](std::uint64_t n) {
    while (n--) {
      stale += transfer_in(inputs);
      bench::keep(locals);
      std::memcpy(mine[kInputs].bytes, &n, sizeof n);
      writer.write(mine[kInputs].bytes, Nanoseconds{1}, 1);
      bench::keep(own);
    }
  });
  comparison.run(raw);
  bench::print(bench::Figure{.row = 5, .what = "transfer of 3 groups in, 1 out", .goal = bench::ratio_at_most(1.3)}
                   .of(comparison, ours));
  print_ten_elements(bench::repetitions(argc, argv));
  return stale == 0 ? 0 : 1;
}
