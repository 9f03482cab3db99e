// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/watch.h"

#include <gtest/gtest.h>

#include "chimera/cli/print/columns.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

Json readings(double error, double q0) {
  return {{"error", {{"value", error}, {"text", Json(error).dump() + " rad"}, {"unit", "rad"}, {"producer", "pid"},
                     {"state", "ON"}, {"valid", true}}},
          {"q", {{"value", {q0, 7.5}}, {"text", "[" + Json(q0).dump() + " 7.5] rad"}, {"unit", "rad"},
                 {"producer", "arm"}, {"state", "ON"}, {"valid", true}}},
          {"x", {{"value", nullptr}, {"text", "never written"}, {"unit", "m"}, {"producer", "walker"},
                 {"state", "OFF"}, {"valid", false}}}};
}

Watch watch(const std::vector<std::string>& names) {
  std::vector<ChannelName> channels;
  for (const std::string& name : names) channels.push_back(read_channel(name).value());
  return Watch(channels);
}

TEST(Watch, ALineForEachVariableToTheLetter) {
  Watch shown = watch({"error", "q", "q[1]", "x", "x.y"});
  for (int i = 0; i < 8; ++i) shown.add(readings(i, -i));
  const std::vector<std::string> expected = {
      "error  7.0 rad           _.-=+*##                 0 .. 7                ",
      "q      [-7.0 7.5] rad    ##*+=-._                 -7 .. 0               ",
      "q[1]   7.5 rad           ========                 7.5 .. 7.5            ",
      "x      never written                              walker is OFF         ",
      "x.y    never written                              walker is OFF         "};
  const std::vector<std::string> lines = shown.lines(72, false);
  ASSERT_EQ(lines.size(), expected.size());
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(lines[i], expected[i]);
}

TEST(Watch, FillsAnyWidth) {
  Watch shown = watch({"error", "q"});
  for (int i = 0; i < 1000; ++i) shown.add(readings(i, -i));
  for (std::size_t width : {0, 1, 10, 40, 80, 200})
    for (const std::string& line : shown.lines(width, true)) EXPECT_EQ(width_of(line), width) << line;
}

TEST(Watch, PlainLinesSayOnlyTheValues) {
  Watch shown = watch({"error", "q[0]", "x", "q[9]"});
  EXPECT_EQ(shown.plain(), "error = ?  q[0] = ?  x = ?  q[9] = ?");
  shown.add(readings(0.25, 3));
  EXPECT_EQ(shown.plain(), "error = 0.25 rad  q[0] = 3 rad  x = never written (walker is OFF)  q[9] = no such element");
}

}  // namespace
}  // namespace chimera::cli
