// SPDX-License-Identifier: Apache-2.0
#include "chimera/draw/gantt.h"

#include <gtest/gtest.h>

namespace chimera::draw {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

TEST(Gantt, DrawsRunsReleasesAndDeadlinesOfEachRow) {
  Gantt picture{"arm & hand", "note", milliseconds(10), {}};
  picture.rows.push_back({"a", "1 ms every 5 ms", milliseconds(5), milliseconds(4), false,
                          {{Nanoseconds{}, milliseconds(1)}, {milliseconds(5), milliseconds(6)}}});
  picture.rows.push_back({"b", "", milliseconds(20), milliseconds(9), true, {{milliseconds(1), milliseconds(4)}}});
  const std::string drawn = svg({picture});
  EXPECT_EQ(drawn.rfind("<svg", 0), 0u);
  EXPECT_NE(drawn.find("arm &amp; hand"), std::string::npos);
  EXPECT_EQ(count(drawn, "fill=\"#2874a6\""), 2u);          // runs of a
  EXPECT_EQ(count(drawn, "fill=\"#c0392b\""), 1u);          // b is late
  EXPECT_EQ(count(drawn, "stroke=\"#333\""), 4u);           // releases at 0, 5, 10 and 0
  EXPECT_EQ(count(drawn, "stroke-dasharray=\"3 2\""), 3u);  // due at 4, 9 and 9
}

TEST(Gantt, ALongNameStaysBesideThePictureAndCanBePointedAt) {
  Gantt picture{"t", "", milliseconds(10), {}};
  picture.rows.push_back({"controller_of_the_left_arm_and_hand", "", milliseconds(5), milliseconds(5), false, {}});
  const std::string drawn = svg({picture});
  EXPECT_NE(drawn.find("<title>controller_of_the_left_arm_and_hand</title>"), std::string::npos) << drawn;
  EXPECT_NE(drawn.find(">controller_of_the_lef...</text>"), std::string::npos) << drawn;
}

TEST(Gantt, LeavesOutReleasesThatAreTooClose) {
  Gantt picture{"t", "", milliseconds(1000), {}};
  picture.rows.push_back({"a", "", milliseconds(1), milliseconds(1), false, {}});
  picture.rows.push_back({"b", "", milliseconds(500), milliseconds(500), false, {}});
  EXPECT_EQ(count(svg({picture}), "stroke=\"#333\""), 3u);  // of b
}

TEST(Gantt, AnEmptyPictureIsAPictureToo) {
  EXPECT_NE(svg({}).find("</svg>"), std::string::npos);
  EXPECT_NE(svg({Gantt{}}).find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace chimera::draw
