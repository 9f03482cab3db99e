// SPDX-License-Identifier: Apache-2.0
// One writer publishes without pause, and readers check every byte. The thread sanitizer reports a race; other builds
// find a torn copy.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "chimera/table/group.h"

namespace chimera::group_threads_test {
namespace {

constexpr std::uint32_t kWords = 64;
constexpr std::uint32_t kPayload = kWords * 8;
using Words = std::array<std::uint64_t, kWords>;

struct alignas(kCacheLine) Memory { std::byte bytes[group_bytes(kPayload)]{}; };

// Every word is a function of the publication it belongs to.
Words words_of(std::uint64_t n) {
  Words w;
  for (std::size_t i = 0; i < kWords; ++i) w[i] = (n * 0x9e3779b97f4a7c15u) ^ i;
  return w;
}

struct Count {
  std::uint64_t good = 0, torn = 0, backwards = 0, refused = 0;
};

constexpr std::uint64_t kFlood = CHIMERA_WORDWISE_COPY ? 50'000 : 200'000;  // the thread sanitizer sees each word

Count read_until(const std::atomic<bool>& stop, const Memory& memory, std::atomic<int>* saw_last = nullptr) {
  GroupReader reader(memory.bytes, kPayload);
  Count count;
  std::uint64_t last = 0;
  while (!stop.load(std::memory_order_relaxed)) {
    chimera_slot header{};
    Words values{};
    if (!reader.try_read(header, reinterpret_cast<std::byte*>(values.data()))) {
      ++count.refused;
      continue;
    }
    const bool whole = header.sequence == 0 ? values == Words{} : values == words_of(header.sequence);
    if (!whole || header.published_ns != static_cast<std::int64_t>(header.sequence)) ++count.torn;
    if (header.sequence < last) ++count.backwards;
    if (saw_last != nullptr && header.sequence == kFlood && last != kFlood) saw_last->fetch_add(1);
    last = header.sequence;
    ++count.good;
  }
  return count;
}

void flood(Memory& memory, std::uint64_t publications) {
  GroupWriter writer(memory.bytes, kPayload);
  for (std::uint64_t n = 1; n <= publications; ++n) {
    const Words w = words_of(n);
    writer.write(reinterpret_cast<const std::byte*>(w.data()), Nanoseconds{static_cast<std::int64_t>(n)}, 1);
    if (n % 64 == 0) std::this_thread::yield();
  }
}

TEST(GroupThreads, FloodingWriterNeverTearsARead) {
  auto memory = std::make_unique<Memory>();
  std::atomic<bool> stop{false};
  std::atomic<int> saw_last{0};
  std::array<Count, 2> counts;
  std::vector<std::thread> readers;
  for (auto& count : counts) readers.emplace_back([&] { count = read_until(stop, *memory, &saw_last); });
  flood(*memory, kFlood);
  while (saw_last.load() != 2) std::this_thread::yield();  // each reader has reached the end
  stop = true;
  for (auto& reader : readers) reader.join();
  for (const Count& count : counts) {
    EXPECT_GT(count.good, 0u);
    EXPECT_EQ(count.torn, 0u);
    EXPECT_EQ(count.backwards, 0u);
  }
}

TEST(GroupThreads, HandOverFromThreadToThreadKeepsTheCountGrowing) {
  auto memory = std::make_unique<Memory>();
  std::atomic<bool> stop{false};
  Count count;
  std::thread reader([&] { count = read_until(stop, *memory); });
  for (std::uint64_t incarnation = 0; incarnation < 20; ++incarnation) {
    std::thread([&] {
      GroupWriter writer(memory->bytes, kPayload);
      EXPECT_EQ(writer.sequence(), incarnation * 500);
      for (int i = 0; i < 500; ++i) {
        const std::uint64_t n = writer.sequence() + 1;
        const Words w = words_of(n);
        writer.write(reinterpret_cast<const std::byte*>(w.data()), Nanoseconds{static_cast<std::int64_t>(n)}, 1);
      }
    }).join();
  }
  stop = true;
  reader.join();
  EXPECT_EQ(count.torn, 0u);
  EXPECT_EQ(count.backwards, 0u);
  EXPECT_EQ(GroupReader(memory->bytes, kPayload).published()->sequence, 10'000u);
}

}  // namespace
}  // namespace chimera::group_threads_test
