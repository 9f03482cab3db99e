// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/expectation.h"

#include <cmath>

#include "chimera/cli/run/testing/test_application.h"

namespace chimera::cli {
namespace {

class ExpectationText : public ::testing::Test {
 protected:
  std::string refusal(const std::string& text) {
    const auto made = Expectation::parse(text, application_.configuration(), library_.units());
    return made ? "accepted" : std::string(made.error().message.view());
  }
  Library library_ = test_library();
  Application application_ = test_application(kCounterText, library_);
};

TEST_F(ExpectationText, TakesEveryComparisonAndConvertsTheUnit) {
  for (const char* text : {"dt < 1 s", "dt<=2 ms", "|dt| > 0.5 us", " | dt | >= 0 s", "count >= 3", "count >= -1e300"})
    EXPECT_EQ(refusal(text), "accepted") << text;
}

TEST_F(ExpectationText, SaysTheValueInItsOwnUnit) {
  std::string said;
  const auto made = Expectation::parse("dt < 2 ms", application_.configuration(), library_.units());
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->holds({true, "0.001 s", {0.001}}, said));
  EXPECT_EQ(said, "dt is 1 ms");
  EXPECT_FALSE(Expectation::with_bound(made->text(), made->bound())->holds({true, "[0.0015 1] s", {0.0015, 1}}, said));
  EXPECT_EQ(said, "dt is [1.5 1000] ms");
}

TEST_F(ExpectationText, RefusesTextThatIsNoComparison) {
  const char* form = "write 'VARIABLE <= QUANTITY', with < <= > or >=";
  EXPECT_EQ(refusal(""), std::string("--expect '': ") + form);
  EXPECT_EQ(refusal("dt = 1 s"), std::string("--expect 'dt = 1 s': ") + form);
}

TEST_F(ExpectationText, RefusesBarsAndComparisonsWithoutAVariable) {
  for (const char* text : {"< 1 s", "|| < 1 s", "| < 1 s", "|dt < 1 s", "| | < 1 s"})
    EXPECT_EQ(refusal(text).rfind(std::string("--expect '") + text + "': no state variable '", 0), 0u)
        << refusal(text);
}

TEST_F(ExpectationText, NamesTheNearestVariable) {
  EXPECT_EQ(refusal("cont < 1"), "--expect 'cont < 1': no state variable 'cont'; did you mean 'count'?");
}

TEST_F(ExpectationText, RefusesInvalidBounds) {
  for (const char* text : {"dt < ", "dt < nan s", "dt < 1e999 s", "dt < 1 kg", "dt < 1", "dt << 1 s", "dt < 1 s < 2 s"})
    EXPECT_EQ(refusal(text).rfind(std::string("--expect '") + text + "': ", 0), 0u) << refusal(text);
}

TEST_F(ExpectationText, AnUnwrittenVariableSatisfiesNoExpectation) {
  const Application source = test_application(
      "subsystem: s\ntasks:\n  a: {component: t_source, constants: {start: 0 m, slope: 1 m/s}}\n", library_);
  const auto made = Expectation::parse("x >= 0 m", source.configuration(), library_.units());
  ASSERT_TRUE(made);
  std::string said;
  EXPECT_FALSE(made->holds(source.probe("x")->sample(), said));
  EXPECT_EQ(said, "x was never written");
}

}  // namespace
}  // namespace chimera::cli
