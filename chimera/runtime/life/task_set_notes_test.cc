// SPDX-License-Identifier: Apache-2.0
// Facts that components learn about their ports, and notes that they leave for their user.
#include <gtest/gtest.h>

#include <string>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/virtual_executor.h"

namespace chimera {
namespace {

struct Teller {
  Many<In<double>>      in{"in*", "U"};
  InConst<std::int32_t> limit{"limit", "1", initial = 3};
  Resource              file{"file"};
  Out<double>           y{"y", "1", initial = 0.0};

  void init(Cycle c) {
    names.clear();
    for (const auto& port : in) names += std::string(c.variable(port)) + " " + std::string(c.unit(port)) + "; ";
    names += std::string(c.variable(limit)) + std::string(c.unit(file)) + "; " + std::string(c.variable(y));
    c.note("without its fan");
  }
  void cycle(Cycle c) {
    if (c.count() == 2) c.note(std::string(400, 'x').c_str());
  }
  static inline std::string names;
};

struct TaskSetNotes : ::testing::Test {
  chimera::testing::TestApplication app;
  std::unique_ptr<HeapTaskSet> set;

  TaskSetNotes() {
    app.add("teller", chimera::testing::component<Teller>("teller"));
    // The first port stands for one instance; another is added behind the last.
    app.link(0, 0, "q");
    app.port(0, 0).unit = "rad";
    app.link(0, 1, {});
    app.link(0, 3, "sum");
    app.give(app.operators, "q", CHIMERA_FLOAT64, chimera::testing::bytes_of(0.5));
    auto made = HeapTaskSet::create(app.make(), app.components);
    if (made) set = *std::move(made);
  }
  const FaultRecord& record() const { return set->tasks()[0].faults; }
};

TEST_F(TaskSetNotes, AComponentKnowsTheNamesAndUnitsOfItsVariables) {
  ASSERT_TRUE(set->life().start({}));
  EXPECT_EQ(Teller::names, "q rad; ; sum");
}

TEST_F(TaskSetNotes, ANoteIsKeptCutAndIsNoFault) {
  VirtualExecutor executor(*set, {}, {});
  ASSERT_TRUE(executor.start());
  EXPECT_STREQ(record().note, "without its fan");
  EXPECT_EQ(record().notes, 1u);
  (void)executor.run(milliseconds(5));
  EXPECT_EQ(std::string(record().note), std::string(CHIMERA_FAULT_TEXT - 1, 'x'));
  EXPECT_EQ(record().notes, 2u);
  EXPECT_EQ(record().told, 2u);
  EXPECT_EQ(record().count, 0u);
  EXPECT_EQ(set->tasks()[0].state, State::kOn);
}

}  // namespace
}  // namespace chimera
