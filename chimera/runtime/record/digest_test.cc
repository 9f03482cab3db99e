// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/record/digest.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera::digest_test {
namespace {

/// A member behind a gap, and a text.
struct Sample {
  bool is_set = false;
  double value = 0;
  char text[8] = {};
};

/// A task of 100 ms whose out-vars are two doubles, a float and a Sample.
class DigestTest : public ::testing::Test, public DigestLines {
 protected:
  DigestTest() {
    ports[0].type = CHIMERA_FLOAT64;
    ports[1].type = CHIMERA_FLOAT32;
    ports[2].type = CHIMERA_STRUCT;
    ports[2].fields = fields;
    ports[2].n_fields = 3;
    component.ports = ports, component.n_ports = 3;
    const std::uint32_t counts[3] = {2, 1, 1}, sizes[3] = {8, 4, sizeof(Sample)}, offsets[3] = {0, 16, 24};
    for (std::uint32_t i = 0; i < 3; ++i) {
      specs[i].declared = i, specs[i].type = ports[i].type, specs[i].element_bytes = sizes[i];
      live[i].count = counts[i];
      outputs[i] = {&live[i], &specs[i], offsets[i], counts[i] * sizes[i]};
    }
    task.id = TaskId(0u);
    task.state = State::kOn;
    task.component = &component;
    task.ports = DeclaredPorts(component);
    task.outputs = outputs;
    begin_again();
  }
  void begin_again() {
    memory.fill(std::byte{0});
    task.group = GroupWriter(memory, kPayload);
    digest.emplace(1, *this, heap);
    digest->begin(kOrigin);
    lines.clear();
  }
  void publish(std::int64_t release_ms) {
    std::byte payload[kPayload] = {};
    std::memset(payload, garbage, sizeof payload);
    std::memcpy(payload, values, sizeof values);
    std::memcpy(payload + 16, &single, sizeof single);
    std::memcpy(payload + 24 + offsetof(Sample, is_set), &sample.is_set, 1);
    std::memcpy(payload + 24 + offsetof(Sample, value), &sample.value, 8);
    std::strncpy(reinterpret_cast<char*>(payload) + 24 + offsetof(Sample, text), sample.text, 3);
    task.group.write(payload, published, valid);
    task.last_release = kOrigin + milliseconds(release_ms);
    digest->add_publication(task);
  }
  void fail(Method method, std::int32_t code, const char* text) {
    ++task.faults.count;
    task.faults.method = method, task.faults.last.code = code;
    std::strcpy(task.faults.last.text, text);
    digest->add_faults(task);
  }
  /// The hash of one publication, and nothing else.
  std::uint64_t hash(std::int64_t release_ms = 100) {
    begin_again();
    publish(release_ms);
    digest->end();
    return lines.at(0).hash;
  }

  static constexpr std::uint32_t kPayload = 24 + sizeof(Sample);
  static constexpr Nanoseconds kOrigin = milliseconds(7);
  std::vector<DigestLine> lines;
  double values[2] = {1.5, 0.0};
  float single = 2;
  Sample sample{true, 3, "ab"};
  std::uint64_t valid = 7;
  Nanoseconds published = milliseconds(1);
  int garbage = 0;
  chimera_component component{};
  Task task;
  std::optional<Digest> digest;

 private:
  void take(const DigestLine& line) noexcept override { lines.push_back(line); }

  const chimera_field fields[3] = {{"is_set", "1", CHIMERA_BOOL, offsetof(Sample, is_set), 1, 1},
                                   {"value", "1", CHIMERA_FLOAT64, offsetof(Sample, value), 1, 8},
                                   {"text", "", CHIMERA_STRING, offsetof(Sample, text), 1, 8}};
  chimera_port_decl ports[3]{};
  PortSpec specs[3];
  chimera_port live[3]{};
  Output outputs[3];
  alignas(64) std::array<std::byte, group_bytes(kPayload)> memory{};
  HeapMemory heap;
};

TEST_F(DigestTest, HashesReleaseSequenceValidBitsAndValues) {
  const std::uint64_t first = hash();
  EXPECT_EQ(hash(), first);
  EXPECT_NE(hash(101), first);
  values[1] = std::bit_cast<double>(std::uint64_t{1});
  EXPECT_NE(hash(), first) << "the last bit of a zero";
  values[1] = -0.0;
  EXPECT_NE(hash(), first);
  values[1] = 0;
  sample.value = 4;
  EXPECT_NE(hash(), first);
  sample.value = 3;
  std::strcpy(sample.text, "ac");
  EXPECT_NE(hash(), first);
  std::strcpy(sample.text, "ab");
  valid = 3;
  EXPECT_NE(hash(), first);
  valid = 7;
  EXPECT_EQ(hash(), first);
  begin_again();
  publish(100), publish(100);
  digest->end();
  EXPECT_NE(lines.at(0).hash, first) << "one publication more";
}

TEST_F(DigestTest, IgnoresInstantsOfPublicationsGapsAndBytesBehindATextsZero) {
  const std::uint64_t first = hash();
  published = milliseconds(50);
  EXPECT_EQ(hash(), first);
  garbage = 0xa5;
  EXPECT_EQ(hash(), first);
}

TEST_F(DigestTest, HashesAllNansAlike) {
  values[0] = std::bit_cast<double>(0x7ff8'0000'0000'0000);
  single = std::bit_cast<float>(0x7fc0'0000);
  const std::uint64_t first = hash();
  values[0] = std::bit_cast<double>(0xfff8'0000'0000'0007);
  single = std::bit_cast<float>(0xffc0'0001);
  EXPECT_EQ(hash(), first);
  values[0] = INFINITY;
  EXPECT_NE(hash(), first);
}

// Pinned: every image of a microcontroller and every later version must find the same.
TEST_F(DigestTest, FindsAPinnedHash) { EXPECT_EQ(hash(), 7143608065767666641u); }

TEST_F(DigestTest, HandsOverALineForEachSecondOfReleases) {
  publish(-100), publish(0), publish(999), publish(1000), publish(3500);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].second, 0);
  EXPECT_EQ(lines[0].publications, 3u);
  EXPECT_EQ(lines[1].second, 1);
  EXPECT_EQ(lines[1].publications, 1u);
  digest->end();
  digest->end();
  ASSERT_EQ(lines.size(), 3u) << "a second without entries has no line";
  EXPECT_EQ(lines[2].second, 3);
}

TEST_F(DigestTest, CountsAPublicationBeforeTheFirstOnAtTheOrigin) {
  const std::uint64_t at_origin = hash(0), before = hash(-kOrigin.count / milliseconds(1).count);
  EXPECT_NE(before, at_origin) << "a release at the zero of the clock";
  task.state = State::kOff;
  EXPECT_EQ(hash(-kOrigin.count / milliseconds(1).count), at_origin);
  task.profile.cycles = 1;
  EXPECT_EQ(hash(-kOrigin.count / milliseconds(1).count), before) << "it was ON";
}

TEST_F(DigestTest, HashesMethodCodeAndTextOfFaults) {
  const auto hash_of = [this](Method method, std::int32_t code, const char* text) {
    task.faults = {};
    begin_again();
    fail(method, code, text);
    digest->end();
    EXPECT_EQ(lines.at(0).faults, 1u);
    EXPECT_EQ(lines.at(0).publications, 0u);
    return lines.at(0).hash;
  };
  const std::uint64_t first = hash_of(Method::kCycle, 3, "broken");
  EXPECT_EQ(hash_of(Method::kCycle, 3, "broken"), first);
  EXPECT_NE(hash_of(Method::kOn, 3, "broken"), first);
  EXPECT_NE(hash_of(Method::kCycle, -3, "broken"), first);
  EXPECT_NE(hash_of(Method::kCycle, 3, "broke"), first);
}

}  // namespace
}  // namespace chimera::digest_test
