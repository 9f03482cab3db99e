// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

/// An encoder with two tracks and optional index: 100 counts to 1 rad.
struct Tracks : Rig {
  explicit Tracks(bool has_index = false, std::uint32_t elements = 1) : Rig("encoder"), has_index_(has_index) {
    extent("n", elements), instances("in", has_index ? 3 : 2);
    for (std::size_t k = 0; k < (has_index ? 3 : 2); ++k) type<bool>("in", k);
    for (std::size_t i = 0; i < elements; ++i) set("span", 1.0, i);
    set("counts", std::int64_t{100});
  }
  void begin() {
    const RigAnswer made = init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(on());
  }
  /// Runs a cycle with the wheel `steps` counts from the place where A and B are both false.
  void turn(std::int64_t steps, bool index = false) {
    const std::int64_t phase = steps & 3;
    set("in", phase == 1 || phase == 2, 0, 0), set("in", phase >= 2, 0, 1);
    if (has_index_) set("in", index, 0, 2);
    EXPECT_TRUE(cycle());
  }
  std::int64_t count() { return get<std::int64_t>("count"); }
  std::int64_t errors() { return get<std::int64_t>("errors"); }
  double position() { return get<double>("position"); }
  double velocity() { return get<double>("velocity"); }
  bool has_index_;
};

/// An encoder with a count of type T: 100 counts to 1 rad.
template <class T>
struct Count : Rig {
  explicit Count(bool has_index = false) : Rig("encoder") {
    extent("n", 1), instances("in", has_index ? 2 : 1);
    type<T>("in", 0);
    if (has_index) type<bool>("in", 1), set("in", false, 0, 1);
    set("span", 1.0), set("counts", std::int64_t{100});
  }
  void begin() {
    const RigAnswer made = init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(on());
  }
  /// Runs a cycle with the device count `value` and returns `count`.
  std::int64_t see(T value) {
    set("in", value);
    const RigAnswer answer = cycle();
    EXPECT_TRUE(answer) << answer.text;
    return get<std::int64_t>("count");
  }
  double velocity() { return get<double>("velocity"); }
};

TEST(Encoder, CountsFourToALineInBothDirections) {
  Tracks rig;
  rig.begin();
  for (std::int64_t k = 0; k <= 250; ++k) rig.turn(k);
  EXPECT_EQ(rig.count(), 250);
  EXPECT_DOUBLE_EQ(rig.position(), 2.5);
  EXPECT_DOUBLE_EQ(rig.velocity(), 10);  // one count per cycle
  for (std::int64_t k = 250; k >= -30; --k) rig.turn(k);
  EXPECT_EQ(rig.count(), -30);
  EXPECT_DOUBLE_EQ(rig.velocity(), -10);
  EXPECT_EQ(rig.errors(), 0);
}

TEST(Encoder, ASpanBelowZeroTurnsTheDirection) {
  Tracks rig;
  rig.set("span", -2.0);
  rig.begin();
  for (std::int64_t k = 0; k <= 10; ++k) rig.turn(k);
  EXPECT_DOUBLE_EQ(rig.position(), -0.2);
  EXPECT_DOUBLE_EQ(rig.velocity(), -20);
}

TEST(Encoder, CountsTheCyclesInWhichBothTracksChanged) {
  Tracks rig;
  rig.begin();
  rig.turn(2);  // place of the first cycle: no step
  EXPECT_EQ(rig.errors(), 0);
  rig.turn(4), rig.turn(6), rig.turn(7);
  EXPECT_EQ(rig.errors(), 2);
  EXPECT_EQ(rig.count(), 1);
}

// A wheel that takes n cycles for a count: the velocity is exact and does not alternate between 0 and 10 rad/s.
TEST(Encoder, MeasuresASlowWheelFromEdgeToEdge) {
  for (const int period : {2, 7, 60}) {
    Tracks rig;
    rig.begin();
    for (int cycle = 0; cycle <= 20 * period; ++cycle) {
      rig.turn(-(cycle / period));
      if (cycle <= 3 * period) continue;
      ASSERT_NEAR(rig.velocity(), -0.01 / (period * 1e-3), 1e-9) << cycle;
    }
  }
}

TEST(Encoder, FallsAsOneOverTheTimeWithoutACountAndThenToZero) {
  Tracks rig;
  rig.set("standstill", 0.05);
  rig.begin();
  for (std::int64_t k = 0; k <= 20; ++k) rig.turn(k);
  for (int wait = 1; wait <= 50; ++wait) {
    rig.turn(20);
    ASSERT_NEAR(rig.velocity(), 10.0 / wait, 1e-9) << wait;
  }
  rig.turn(20);
  EXPECT_EQ(rig.velocity(), 0);
}

// A wheel that turns back passes the same edge, so it has not moved.
TEST(Encoder, StandsWhenItTremblesAboutAnEdge) {
  Tracks rig;
  rig.begin();
  for (std::int64_t k : {0, 1, 0, 1, 0, 1, 0}) {
    rig.turn(k);
    EXPECT_EQ(rig.velocity(), 0);
  }
  rig.turn(-1);
  EXPECT_DOUBLE_EQ(rig.velocity(), -10);
}

TEST(Encoder, AWindowTakesTheMeanOfUnevenCounts) {
  for (const bool has_window : {false, true}) {
    Count<std::int64_t> rig;
    if (has_window) rig.set("window", 20e-3);
    rig.begin();
    double least = 1e9, most = 0;
    for (int cycle = 0; cycle < 500; ++cycle) {
      rig.see(static_cast<std::int64_t>(std::floor(1.3 * cycle)));  // 13 rad/s
      if (cycle > 50) least = std::min(least, rig.velocity()), most = std::max(most, rig.velocity());
    }
    EXPECT_NEAR(has_window ? least : most, has_window ? 13 : 20, has_window ? 0.6 : 1e-9);
    EXPECT_NEAR(has_window ? most : least, has_window ? 13 : 10, has_window ? 0.6 : 1e-9);
  }
}

TEST(Encoder, ACountOf32BitsWrapsByItselfAndOthersAtWrap) {
  Count<std::int32_t> rig;
  rig.begin();
  EXPECT_EQ(rig.see(2147483640), 0);
  EXPECT_EQ(rig.see(-2147483640), 16);
  EXPECT_DOUBLE_EQ(rig.velocity(), 0);  // the first edge
  EXPECT_EQ(rig.see(2147483647), 7);
  Count<double> sixteen;
  sixteen.set("wrap", std::int64_t{65536});
  sixteen.begin();
  EXPECT_EQ(sixteen.see(65530), 0);
  EXPECT_EQ(sixteen.see(4), 10);
  EXPECT_EQ(sixteen.see(65526), -4);
  std::int64_t way = -4;
  double at = 65526;
  for (int k = 0; k < 100; ++k) {
    at = std::fmod(at + 30000, 65536), way += 30000;
    ASSERT_EQ(sixteen.see(at), way);
  }
  EXPECT_DOUBLE_EQ(sixteen.velocity(), 300 * 1000);
  Count<std::int64_t> wide;
  wide.begin();
  EXPECT_EQ(wide.see(std::numeric_limits<std::int64_t>::max()), 0);
  EXPECT_EQ(wide.see(std::numeric_limits<std::int64_t>::min()), 1);
}

TEST(Encoder, AnAbsoluteOneKnowsWhereItIsAndUnwinds) {
  Count<std::int32_t> rig;
  rig.set("wrap", std::int64_t{4096}), rig.set("is_absolute", true);
  rig.begin();
  EXPECT_EQ(rig.see(4000), 4000);
  EXPECT_EQ(rig.see(100), 4196);
  EXPECT_DOUBLE_EQ(rig.get<double>("position"), 41.96);
}

TEST(Encoder, TheFirstIndexOrEveryOneIsZero) {
  for (const char* zero_at : {"first", "every"}) {
    Tracks rig(true);
    rig.set("zero_at", Text<16>(zero_at));
    rig.begin();
    for (std::int64_t k = 0; k < 250; ++k) rig.turn(k, k % 100 == 50);
    EXPECT_TRUE(rig.get<bool>("is_referenced"));
    EXPECT_EQ(rig.count(), std::string("first") == zero_at ? 199 : 99) << zero_at;
    EXPECT_DOUBLE_EQ(rig.velocity(), 10);
  }
}

TEST(Encoder, AnIndexThatIsTrueAtTheFirstReadingDoesNotCount) {
  Count<std::int32_t> rig(true);
  rig.set("in", true, 0, 1);
  rig.begin();
  rig.see(10), rig.see(12);
  EXPECT_FALSE(rig.get<bool>("is_referenced"));
  rig.set("in", false, 0, 1), rig.see(14);
  rig.set("in", true, 0, 1);
  EXPECT_EQ(rig.see(20), 0);
  EXPECT_TRUE(rig.get<bool>("is_referenced"));
  EXPECT_EQ(rig.see(25), 5);
}

TEST(Encoder, KeepsItsCountAndLosesItsReference) {
  Count<std::int32_t> rig(true);
  rig.begin();
  rig.see(0);
  rig.set("in", true, 0, 1), rig.see(5);
  EXPECT_EQ(rig.see(12), 7);
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  EXPECT_FALSE(rig.get<bool>("is_referenced"));
  EXPECT_EQ(rig.see(500), 7);
  EXPECT_EQ(rig.see(501), 8);
}

TEST(Encoder, CountsEachElementByItself) {
  Tracks rig(false, 2);
  rig.begin();
  for (std::size_t i = 0; i < 2; ++i) rig.set("in", false, i, 0), rig.set("in", false, i, 1);
  ASSERT_TRUE(rig.cycle());
  rig.set("in", true, 0, 0), rig.set("in", true, 1, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int64_t>("count", 0), 1);
  EXPECT_EQ(rig.get<std::int64_t>("count", 1), -1);
}

TEST(Encoder, AnInvalidCountIsAFaultOfItsCycleOnly) {
  Count<double> rig;
  rig.begin();
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  rig.see(3), rig.see(5);
  rig.set("in", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "in[0][0] is nan: a count is finite and at most 2^53");
  EXPECT_TRUE(rig.error());
  rig.set("in", 1e18);
  EXPECT_EQ(rig.cycle().text, "in[0][0] is 1e+18: a count is finite and at most 2^53");
  EXPECT_EQ(rig.see(7), 4);
}

template <class... Types>
std::string refusal_of_inputs() {
  Rig rig("encoder");
  rig.extent("n", 1), rig.instances("in", sizeof...(Types));
  std::size_t k = 0;
  (rig.type<Types>("in", k++), ...);
  rig.set("span", 1.0);
  return rig.init().text;
}

TEST(Encoder, RefusesInputsThatAreNoEncoder) {
  EXPECT_EQ(refusal_of_inputs(), "name the tracks A and B, or a count");
  EXPECT_EQ(refusal_of_inputs<bool>(), "in[0] is the track A: name the track B, too");
  EXPECT_EQ((refusal_of_inputs<bool, double>()), "behind in[0] there are truth values: the track B, or the index");
  EXPECT_EQ((refusal_of_inputs<std::int32_t, bool, bool>()), "behind a count there is an index and nothing else");
  EXPECT_EQ((refusal_of_inputs<bool, bool, bool>()), "");
  EXPECT_EQ((refusal_of_inputs<float, bool>()), "");
}

TEST(Encoder, RefusesWrongConstants) {
  const auto wrong = [](Rig&& rig, const char* port, auto value) {
    rig.set(port, value);
    return rig.init().text;
  };
  EXPECT_EQ(wrong(Tracks(), "span", 0.0), "span must be finite and not 0");
  EXPECT_EQ(wrong(Tracks(), "span", std::nan("")), "span must be finite and not 0");
  EXPECT_EQ(wrong(Tracks(), "counts", std::int64_t{0}), "counts must be 1 to 2^53");
  EXPECT_EQ(wrong(Count<double>(), "wrap", std::int64_t{1}), "wrap must be 2 to 2^53, or 0 for none");
  EXPECT_EQ(wrong(Tracks(), "wrap", std::int64_t{4096}), "wrap and is_absolute are for a count, not for tracks");
  EXPECT_EQ(wrong(Tracks(), "is_absolute", true), "wrap and is_absolute are for a count, not for tracks");
  EXPECT_EQ(wrong(Tracks(), "zero_at", Text<16>("second")), "zero_at must be first or every");
  const char* kTimes = "window must be 0 to 86400 s, and standstill 0.000001 to 86400 s";
  EXPECT_EQ(wrong(Tracks(), "window", -1.0), kTimes);
  EXPECT_EQ(wrong(Tracks(), "standstill", 0.0), kTimes);
}

}  // namespace
}  // namespace chimera
