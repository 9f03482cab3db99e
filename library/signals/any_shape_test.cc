// SPDX-License-Identifier: Apache-2.0
// Every signal component accepts scalars, lists and matrices and handles each element independently.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Signal {
  const char* component;
  std::function<void(Rig&, std::size_t)> give;  // sets the constants of one element
  double least, most;                           // range of y at x = 3
};

void fill(Rig& rig, const char* port, double value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) rig.set(port, value, i);
}

const Signal kSignals[] = {
    {"limit", [](Rig& r, std::size_t n) { fill(r, "low", -1, n), fill(r, "high", 1, n); }, 1, 1},
    {"deadband", [](Rig& r, std::size_t n) { fill(r, "width", 1, n), fill(r, "center", 0, n); }, 2, 2},
    {"rate_limit", [](Rig& r, std::size_t n) { fill(r, "rise", 1, n), fill(r, "fall", 1, n); }, 3, 3},
    {"lowpass", [](Rig& r, std::size_t) { r.set("cutoff", 50.0); }, 2.999999, 3.000001},
    {"notch", [](Rig& r, std::size_t) { r.set("center", 50.0), r.set("width", 5.0); }, 2.999999, 3.000001},
    {"unit_convert", [](Rig& r, std::size_t) { r.set("factor", 2.0); }, 6, 6},
    {"offset", [](Rig& r, std::size_t n) { fill(r, "offset", 1, n); }, 4, 4},
    {"lookup_table",
     [](Rig& r, std::size_t) {
       r.extent("points", 2);
       for (std::size_t k = 0; k < 2; ++k) r.set("at", k == 0 ? 0.0 : 6.0, k), r.set("value", k == 0 ? 1.0 : 0.0, k);
     }, 0.5, 0.5}};

struct AnyShape : ::testing::TestWithParam<Signal> {
  Rig rig{GetParam().component};

  void begin(std::uint32_t rows, std::uint32_t columns) {
    rig.shape("n", rows, columns);
    const std::size_t count = std::size_t{rows} * columns;
    GetParam().give(rig, count);
    fill(rig, "x", 0.5, count);
    rig.set("x", 3.0, count - 1);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
    ASSERT_EQ(rig.size("y"), count);
    const RigAnswer answer = rig.cycle();
    ASSERT_TRUE(answer) << answer.text;
  }
};

TEST_P(AnyShape, EachElementOfAMatrixByItself) {
  begin(3, 4);
  EXPECT_GE(rig.get<double>("y", 11), GetParam().least);
  EXPECT_LE(rig.get<double>("y", 11), GetParam().most);
  for (std::size_t i = 1; i < 11; ++i) EXPECT_EQ(rig.get<double>("y", i), rig.get<double>("y", 0));
  EXPECT_NE(rig.get<double>("y", 0), rig.get<double>("y", 11));
}

TEST_P(AnyShape, AFaultNamesTheElementRowByRow) {
  begin(2, 2);
  rig.set("x", std::nan(""), 2);
  EXPECT_EQ(rig.cycle().text, "x[2] is not a finite number");
}

TEST_P(AnyShape, TheLargestMatrixAndAScalar) {
  begin(8, 8);
  EXPECT_LE(rig.get<double>("y", 63), GetParam().most);
  Rig scalar(GetParam().component);
  scalar.shape("n", 1, 1);
  GetParam().give(scalar, 1);
  scalar.set("x", 3.0);
  ASSERT_TRUE(scalar.init());
  ASSERT_TRUE(scalar.on());
  ASSERT_TRUE(scalar.cycle());
  EXPECT_GE(scalar.get<double>("y"), GetParam().least);
}

INSTANTIATE_TEST_SUITE_P(Signals, AnyShape, ::testing::ValuesIn(kSignals),
                         [](const auto& of) { return std::string(of.param.component); });

}  // namespace
}  // namespace chimera
