// SPDX-License-Identifier: Apache-2.0
// Row 5: the whole transfer of a task in one cycle - three foreign groups in, its own out, 80 B each - beside the same
// four copies alone.
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
  return stale == 0 ? 0 : 1;
}
