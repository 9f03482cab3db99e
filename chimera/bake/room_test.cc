// SPDX-License-Identifier: Apache-2.0
#include "chimera/bake/room.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace chimera::bake {
namespace {

struct Scene {
  Scene() {
    constants[0].type = CHIMERA_INT32;
    constants[0].element_bytes = 4;
    constants[0].value = std::as_bytes(std::span(&joints, 1));
    constants[1].value = numbers;
    port.constant = ConstantId(1u);
    port.element_bytes = 8;
    port.extent[0] = {.max = 10, .constant = ConstantId(0u)};
    port.value = numbers;
    task.ports = {&port, 1};
    spec.tasks = {&task, 1};
    spec.constants = constants;
  }

  std::int32_t joints = 2;
  std::array<std::byte, 80> numbers{};
  PortOf producer{TaskId(0u), 0};
  ConstantSpec constants[2];
  PortSpec port;
  TaskSpec task;
  ApplicationSpec spec;
};

TEST(Room, IsThatOfTheConstantOfTheDescription) {
  Scene scene;
  fit(scene.port, scene.spec);
  EXPECT_EQ(scene.port.max_bytes(), 16u);
  EXPECT_EQ(scene.port.value.size(), 16u);
  fit(scene.constants[1], ConstantId(1u), scene.spec);
  EXPECT_EQ(scene.constants[1].value.size(), 16u);
  GivenSpec given;
  given.element_bytes = 8;
  given.extent[0] = {.max = 10, .constant = ConstantId(0u)};
  given.value = scene.numbers;
  fit(given, scene.spec);
  EXPECT_EQ(given.value.size(), 16u);
  EXPECT_EQ(given.extent[0].max, 2u);
}

TEST(Room, StaysForMatricesAndForConstantsThatATaskMakes) {
  Scene scene;
  scene.port.extent[1].max = 3;
  fit(scene.port, scene.spec);
  EXPECT_EQ(scene.port.extent[0].max, 10u);
  scene.port.extent[1].max = 1;
  scene.constants[0].producers = {&scene.producer, 1};
  fit(scene.port, scene.spec);
  EXPECT_EQ(scene.port.extent[0].max, 10u);
}

}  // namespace
}  // namespace chimera::bake
