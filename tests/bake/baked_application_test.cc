// SPDX-License-Identifier: Apache-2.0
// Compiled with the tables of one application: tests/bake/CMakeLists.txt.
#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>
#include <fstream>
#include <map>
#include <vector>

#include "chimera/bake/room.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/cli/run/digest_text.h"
#include "chimera/load/shared_object.h"
#include "chimera/runtime/executive/baked.h"
#include "chimera/runtime/hosted/asked_sets.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/record/digest.h"
#include "chimera/runtime/testing/spec_equal.h"
#include "chimera/runtime/virtual/virtual_executor.h"
#include "chimera/verify/verify.h"

namespace chimera::baked_application_test {

const Library& library() {
  static const Result<Library> kLibrary =
      Workplace::around(std::string(std::getenv("CHIMERA_BUILD")) + "/bin/chimera").library();
  EXPECT_TRUE(kLibrary);
  return *kLibrary;
}

TEST(BakedApplication, IsTheApplicationOfTheDescription) {
  const Verdict verdict = verify(read_description_file(BAKED_DESCRIPTION), library());
  ASSERT_TRUE(verdict.configuration) << verdict.report.text();
  const ApplicationSpec& described = verdict.configuration->spec();
  ApplicationSpec expected = described;
  std::vector<TaskSpec> tasks(described.tasks.begin(), described.tasks.end());
  std::deque<std::vector<PortSpec>> ports;
  for (TaskSpec& task : tasks) {
    task.budget = task.min_time = {};  // of another machine
    for (PortSpec& port : ports.emplace_back(task.ports.begin(), task.ports.end())) bake::fit(port, described);
    task.ports = ports.back();
  }
  expected.tasks = tasks;
  std::vector<GivenSpec> operators(described.operators.begin(), described.operators.end());
  for (GivenSpec& given : operators) bake::fit(given, described);
  expected.operators = operators;
  std::vector<ConstantSpec> constants(described.constants.begin(), described.constants.end());
  for (std::size_t c = 0; c < constants.size(); ++c) bake::fit(constants[c], ConstantId(c), expected);
  expected.constants = constants;
  EXPECT_EQ(testing::first_difference(baked::kSpec, expected), "");
}

TEST(BakedApplication, HasOneComponentForEachTask) {
  ASSERT_EQ(baked::kComponents.size(), baked::kSpec.tasks.size());
  for (const chimera_component* component : baked::kComponents) EXPECT_NE(component, nullptr);
}

TEST(BakedApplication, HasValuesThatAProcessorCanReadInPlace) {
  for (const TaskSpec& task : baked::kSpec.tasks)
    for (const PortSpec& port : task.ports) {
      const auto address = reinterpret_cast<std::uintptr_t>(port.value.data());
      EXPECT_EQ(address % 8, 0u) << task.name;
    }
}

TEST(BakedApplication, GivesTheDigestOfTheDescription) {
  const ApplicationSpec& spec = baked::kSpec;
  std::vector<const chimera_component*> components;
  std::map<std::string_view, SharedObject> opened;
  for (const TaskSpec& task : spec.tasks) {
    const LibraryEntry* entry = library().find(task.component);
    ASSERT_NE(entry, nullptr) << task.component;
    auto object = SharedObject::open(entry->object_file);
    ASSERT_TRUE(object) << object.error().message.c_str();
    const auto& kept = opened.emplace(task.component, *std::move(object)).first->second;
    components.push_back(*kept.component(task.component));
  }
  auto set = HeapTaskSet::create(spec, components);
  ASSERT_TRUE(set) << set.error().message.c_str();
  HeapMemory memory;
  cli::DigestText text;
  Digest digest(spec.tasks.size(), text, memory);
  AskedSets asked(spec, false);
  RunOptions options;
  options.script = Script(baked::kRun.acts);
  options.asked = &asked;
  options.digest = &digest;
  VirtualOptions how;
  how.times = JobTimes::none();
  VirtualExecutor executor(**set, options, how);
  ASSERT_TRUE(executor.start());
  executor.run(baked::kRun.duration);
  digest.end();
  std::ifstream file(BAKED_DIGEST);
  const std::string expected{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GT(expected.size(), 100u);
  EXPECT_EQ(text.text(spec), expected);
  executor.shut_down();
}

}  // namespace chimera::baked_application_test
