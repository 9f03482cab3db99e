// SPDX-License-Identifier: Apache-2.0
// Row 3: reading beside a writer of 100 kHz on another CPU: nothing torn, no read given up, and the slow reads (p99)
// beside memcpy of the same bytes from the same moving memory. The writer is paced by the clock, without sleeping.
#include <atomic>
#include <cstdio>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "bench/bench.h"
#include "chimera/platform/cycle_counter.h"
#include "chimera/table/group.h"

namespace chimera {
namespace {

constexpr std::size_t kSamples = 200'000;
constexpr double kWriterPeriodNs = 10'000;

struct alignas(kCacheLine) Line {
  std::byte b[kCacheLine]{};
};

std::uint64_t word_of(std::uint64_t n, std::size_t i) { return n * 0x9e3779b97f4a7c15u ^ i; }

struct Measured {
  std::vector<double> ns;
  std::uint64_t torn = 0, refused = 0;
};

class Beside100kHz {
 public:
  explicit Beside100kHz(std::uint32_t payload)
      : payload_(payload), memory_(group_bytes(payload) / kCacheLine), reader_(memory_[0].b, payload) {}

  void run() {
    bench::Beside writer(0, [this] { write_until_stopped(); });
    while (reader_.published()->sequence < 1000) std::this_thread::yield();
    const CycleCounter clock = CycleCounter::calibrate();
    std::vector<std::uint64_t> values(payload_ / 8);
    auto* target = reinterpret_cast<std::byte*>(values.data());
    Measured ours, raw;
    for (std::size_t k = 0; k < kSamples; ++k) {
      chimera_slot header{};
      const Nanoseconds begin = clock.now();
      const bool ok = reader_.try_read(header, target);
      const Nanoseconds middle = clock.now();
      if (!ok) ++ours.refused;
      else if (!is_whole(header.sequence, values)) ++ours.torn;
      const Nanoseconds again = clock.now();
      std::size_t size = payload_;
      asm volatile("" : "+r"(size));
      std::memcpy(target, reader_.published() + 1, size);
      bench::keep(*target);
      const Nanoseconds end = clock.now();
      ours.ns.push_back(static_cast<double>((middle - begin).count));
      raw.ns.push_back(static_cast<double>((end - again).count));
      if (k % 1000 == 999) std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    stop_ = true;
    report(ours, raw);
  }

 private:
  void write_until_stopped() {
    GroupWriter writer({memory_[0].b, memory_.size() * kCacheLine}, payload_);
    std::vector<std::uint64_t> values(payload_ / 8);
    double next = bench::now_ns();
    while (!stop_.load(std::memory_order_relaxed)) {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = word_of(writer.sequence() + 1, i);
      writer.write(reinterpret_cast<const std::byte*>(values.data()), Nanoseconds{1}, 1);
      next = std::max(next + kWriterPeriodNs, bench::now_ns());  // what a stall dropped is not made up for in a burst
      while (bench::now_ns() < next) {
      }
    }
  }

  static bool is_whole(std::uint64_t n, const std::vector<std::uint64_t>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] != word_of(n, i)) return false;
    return true;
  }

  void report(const Measured& ours, const Measured& raw) const {
    const std::string size = std::to_string(payload_) + " B beside a 100 kHz writer";
    bench::Figure p99{.row = 3, .what = "p99 of reading " + size, .goal = bench::ratio_at_most(4)};
    p99.figure = bench::quantile(ours.ns, 0.99);
    p99.baseline = bench::quantile(raw.ns, 0.99);
    p99.baseline_name = "memcpy";
    p99.ratio = p99.figure / p99.baseline;
    p99.n = kSamples;
    bench::print(p99);
    bench::Figure torn{.row = 3, .what = "torn reads of " + size, .unit = "reads", .goal = bench::figure_at_most(0)};
    torn.figure = static_cast<double>(ours.torn);
    torn.n = kSamples;
    bench::print(torn);
    bench::Figure refused{
        .row = 3, .what = "reads given up of " + size, .unit = "reads", .goal = bench::figure_at_most(0)};
    refused.figure = static_cast<double>(ours.refused);
    refused.n = kSamples;
    bench::print(refused);
  }

  std::uint32_t payload_;
  std::vector<Line> memory_;
  GroupReader reader_;
  std::atomic<bool> stop_{false};
};

}  // namespace
}  // namespace chimera

int main() {
  if (std::thread::hardware_concurrency() < 2) {
    std::fprintf(stderr, "row 3 needs two CPUs\n");
    return 1;
  }
  const chimera::bench::Stage stage;
  for (const std::uint32_t payload : {80u, 512u, 4096u}) chimera::Beside100kHz(payload).run();
}
