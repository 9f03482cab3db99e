// SPDX-License-Identifier: Apache-2.0
// Row 4, without the installed peers: reading 80 B from the register beside what a user would write without it: a
// process-shared mutex with priority inheritance round a struct, and LinuxCNC's pin pattern (one volatile load and
// store per value; cheap, but values of two cycles mix). How often cheaper: baseline / figure.
#include <pthread.h>

#include <atomic>
#include <cstdio>
#include <cstring>
#include <thread>

#include "bench/bench.h"
#include "chimera/table/group.h"

namespace chimera {
namespace {

constexpr std::uint32_t kPayload = 80;
constexpr std::size_t kValues = kPayload / sizeof(double);

class SharedStruct {
 public:
  SharedStruct() {
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    pthread_mutexattr_setpshared(&attributes, PTHREAD_PROCESS_SHARED);
    pthread_mutex_init(&mutex_, &attributes);
  }
  void read(double* to) {
    pthread_mutex_lock(&mutex_);
    std::memcpy(to, values_, sizeof values_);
    pthread_mutex_unlock(&mutex_);
  }

 private:
  pthread_mutex_t mutex_;
  double values_[kValues]{};
};

// A pin is a pointer into shared memory, looked up at start and dereferenced in every cycle.
struct Pins {
  Pins() {
    for (std::size_t i = 0; i < kValues; ++i) pin[i] = &signal[i];
  }
  void read(double* to) const {
    for (std::size_t i = 0; i < kValues; ++i) to[i] = *pin[i];
  }
  volatile double signal[kValues]{};
  volatile double* pin[kValues];
};

struct alignas(kCacheLine) Memory {
  std::byte bytes[group_bytes(kPayload)]{};
};

template <class Read>
auto looped(Read read) {
  return [read](std::uint64_t n) mutable {
    alignas(8) double values[kValues];
    while (n--) {
      read(values);
      bench::keep(values);
    }
  };
}

// `reads` cheaper than `other` by the median of their ratios.
void report(const bench::Comparison& all, std::size_t ours, std::size_t other, const char* what, bench::Goal goal) {
  bench::Figure figure{.row = 4, .what = what, .goal = goal};
  figure.figure = all.cost(ours);
  figure.baseline = all.cost(other);
  figure.baseline_name = all.name(other);
  figure.ratio = goal.at_most ? all.ratio(ours, other) : all.ratio(other, ours);
  figure.aa_spread = all.aa_spread();
  figure.n = all.n();
  bench::print(figure);
}

template <class Read>
bench::Comparison::Body beside(std::atomic<int>& turn, int mine, Read read) {
  return [&turn, mine, body = looped(read)](std::uint64_t n) mutable {
    turn = mine;
    body(n);
    turn = 0;
  };
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  using namespace chimera;
  const bench::Stage stage;
  Memory memory;
  GroupWriter(memory.bytes, kPayload).publish(Nanoseconds{1}, 1);
  const GroupReader reader(memory.bytes, kPayload);
  SharedStruct locked;
  const Pins pins;
  const auto from_register = [&](double* to) {
    chimera_slot header{};
    if (!reader.try_read(header, reinterpret_cast<std::byte*>(to))) std::exit(1);
  };
  const auto from_mutex = [&](double* to) { locked.read(to); };
  const auto from_pins = [&](double* to) { pins.read(to); };

  // Which of the three the second reader, on the other CPU, reads just now; 0 none.
  std::atomic<int> turn{0};
  std::atomic<bool> stop{false};
  bench::Beside second(0, [&] {
    alignas(8) double values[kValues];
    while (!stop.load(std::memory_order_relaxed)) {
      const int now = turn.load(std::memory_order_relaxed);
      if (now == 0) std::this_thread::yield();
      if (now == 1) from_register(values);
      if (now == 2) from_mutex(values);
    }
  });

  bench::Comparison alone(bench::repetitions(argc, argv));
  const auto ours = alone.add("register", looped(from_register));
  const auto mutex = alone.add("PI mutex, process-shared", looped(from_mutex));
  const auto pin = alone.add("LinuxCNC pin pattern", looped(from_pins));
  alone.run(ours);
  report(alone, ours, mutex, "read 80 B, times cheaper than a mutex", bench::ratio_at_least(5));
  report(alone, ours, pin, "read 80 B beside the pin pattern", {});
  if (std::thread::hardware_concurrency() > 1) {
    bench::Comparison two(bench::repetitions(argc, argv, 101));
    const auto our_two = two.add("register", beside(turn, 1, from_register));
    const auto mutex_two = two.add("PI mutex, process-shared", beside(turn, 2, from_mutex));
    two.run(our_two);
    report(two, our_two, mutex_two, "read 80 B with two readers, times cheaper than a mutex",
           bench::ratio_at_least(15));
  }
  stop = true;
}
