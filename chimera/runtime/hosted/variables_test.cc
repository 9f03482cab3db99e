// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/variables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

using testing::component;
using testing::TestApplication;

struct Origin {
  Out<double> out{"out", "1"};
  void cycle(Cycle) { *out = 1; }
};

struct Passing {
  In<double> in{"in", "1"};
  Out<double> out{"out", "1"};
  void cycle(Cycle) { *out = *in; }
};

class SmallestLegalSet : public ::testing::Test {
 protected:
  void origin(const char* name, const char* out) {
    app_.add(name, component<Origin>("origin"));
    app_.link(app_.tasks.size() - 1, 0, out);
  }
  void passing(const char* name, const char* in, const char* out) {
    app_.add(name, component<Passing>("passing"));
    app_.link(app_.tasks.size() - 1, 0, in);
    app_.link(app_.tasks.size() - 1, 1, out);
  }
  /// The explanation if exactly these tasks are ON.
  std::string explain(std::vector<std::string_view> names) {
    const ApplicationSpec& spec = app_.make();
    std::vector<bool> on;
    for (const TaskSpec& task : spec.tasks)
      on.push_back(std::find(names.begin(), names.end(), task.name) != names.end());
    return Variables(spec).explain(on, spec.tasks);
  }

  TestApplication app_;
};

TEST_F(SmallestLegalSet, IsNamedWhereAVariableHasAlternativeProducers) {
  passing("servo", "ref", "u");
  passing("follow", "target", "ref");
  origin("camera", "target");
  origin("hold", "ref");
  EXPECT_EQ(explain({"servo"}), "ref would have no producer; the smallest legal set is: servo hold");
  EXPECT_EQ(explain({"servo", "follow"}),
            "target would have no producer; the smallest legal set is: servo follow camera");
  EXPECT_EQ(explain({"servo", "hold"}), "");
}

TEST_F(SmallestLegalSet, IsTheFirstInTheOrderOfTheDescriptionAmongEquals) {
  passing("servo", "ref", "u");
  origin("right", "ref");
  origin("left", "ref");
  EXPECT_EQ(explain({"servo"}), "ref would have no producer; the smallest legal set is: servo right");
}

TEST_F(SmallestLegalSet, LeavesOutAProducerThatWouldGiveAnotherVariableASecondOne) {
  passing("servo", "ref", "u");
  passing("both", "u", "ref");  // reads what servo gives: legal, though in a ring
  EXPECT_EQ(explain({"servo"}), "ref would have no producer; the smallest legal set is: servo both");
  app_.link(1, 0, "unproduced");
  EXPECT_EQ(explain({"servo"}), "ref would have no producer") << "nothing legal holds it";
}

TEST_F(SmallestLegalSet, IsNotNamedWhereTwoProducersAreOn) {
  origin("a", "ref");
  origin("b", "ref");
  EXPECT_EQ(explain({"a", "b"}), "ref would have two producers: a and b");
}

TEST_F(SmallestLegalSet, IsFoundAmongManyAlternativesInBoundedTime) {
  constexpr int kLevels = 40, kEach = 4;
  std::deque<std::string> names;  // they stay where they are
  const auto keep = [&names](std::string name) { return names.emplace_back(std::move(name)).c_str(); };
  passing("user", "v0", "u");
  for (int level = 0; level < kLevels; ++level)
    for (int i = 0; i < kEach; ++i) {
      const char* const task = keep("t" + std::to_string(level) + "_" + std::to_string(i));
      const char* const out = keep("v" + std::to_string(level));
      if (i == kEach - 1 && level == 2)
        origin(task, out);
      else
        passing(task, keep("v" + std::to_string(level + 1)), out);
    }
  const std::string said = explain({"user"});
  EXPECT_EQ(said.find("v0 would have no producer"), 0u) << said;
}

}  // namespace
}  // namespace chimera
