// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/state/constant_store.h"

#include <gtest/gtest.h>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

struct ConstantStoreTest : ::testing::Test {
  ConstantStoreTest() {
    constants[0].name = "given";
    constants[0].type = CHIMERA_INT32;
    constants[0].value = bytes_of(seven);
    constants[1].name = "made";
    constants[1].type = CHIMERA_INT64;
    for (PortSpec& port : ports) {
      port.kind = CHIMERA_IN_CONST;
      port.constant = kMade;
      port.element_bytes = 8;
    }
    ports[1].extent[0].max = 3;
    task.ports = ports;
    spec.tasks = {&task, 1};
    spec.constants = constants;
  }

  static constexpr ConstantId kGiven{0u}, kMade{1u};
  const std::int32_t seven = 7;
  ConstantSpec constants[2];
  PortSpec ports[2];
  TaskSpec task;
  ApplicationSpec spec;
  HeapMemory heap;
};

TEST_F(ConstantStoreTest, KnowsTheConstantsOfTheDescription) {
  const ConstantStore store(spec, heap);
  EXPECT_TRUE(store[kGiven].is_known);
  EXPECT_EQ(store.integer(kGiven, -1), 7);
  EXPECT_FALSE(store[kMade].is_known);
  EXPECT_EQ(store.integer(kMade, -1), -1);
}

TEST_F(ConstantStoreTest, HasRoomForTheLargestPort) { EXPECT_EQ(ConstantStore(spec, heap)[kMade].value.size(), 24u); }

TEST_F(ConstantStoreTest, ReportsWhetherAValueHasChanged) {
  ConstantStore store(spec, heap);
  const std::int64_t one[3] = {1, 2, 3}, other[3] = {1, 2, 4};
  EXPECT_TRUE(store.set(kMade, 0, bytes_of(one)));
  EXPECT_FALSE(store.set(kMade, 0, bytes_of(one)));
  EXPECT_TRUE(store.set(kMade, 0, bytes_of(other)));
  EXPECT_EQ(store.integer(kMade, -1), 1);
}

TEST_F(ConstantStoreTest, KeepsAValueForEachProducerOfWhichOneCounts) {
  const PortOf producers[2] = {{TaskId(3u), 0}, {TaskId(5u), 1}};
  constants[1].producers = producers;
  ConstantStore store(spec, heap);
  const std::int64_t one = 1, other = 2;
  EXPECT_TRUE(store.set_by(TaskId(3u), kMade, bytes_of(one)));
  EXPECT_TRUE(store.set_by(TaskId(5u), kMade, bytes_of(other)));
  EXPECT_EQ(store.integer(kMade, -1), 1);
  store.choose(kMade, 1);
  EXPECT_EQ(store.integer(kMade, -1), 2);
  EXPECT_FALSE(store.set(kMade, 1, bytes_of(other)));
  EXPECT_EQ(store.of(kMade, 0).value[0], std::byte{1});
  EXPECT_EQ(store.integer(kGiven, -1), 7);
}

TEST_F(ConstantStoreTest, ANumberThatDoesNotFitItsBytesIsNone) {  // an image may say so
  constants[0].type = CHIMERA_INT64;
  EXPECT_EQ(ConstantStore(spec, heap).integer(kGiven, -1), -1);
}

}  // namespace
}  // namespace chimera
