// SPDX-License-Identifier: Apache-2.0
#include "chimera/draw/graph.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <set>

#include "chimera/draw/layout.h"

namespace chimera::draw::graph_test {
namespace {

using enum PortKind;

/// Figure 4 of the 1994 paper, with a display that two lines feed.
Graph figure4() {
  return {"puma_pid",
          {{"trajectory", "joint_trajectory", "100 Hz", "",
            {{kInConst, "ndof", "ndof"}, {kOut, "q", "q_d"}, {kOut, "qd", "qd_d"}}},
           {"pid", "pid_joint", "1 kHz", "ON",
            {{kIn, "q_ref", "q_d"}, {kIn, "qd_ref", "qd_d"}, {kIn, "q", "q"}, {kIn, "kp", "kp"},
             {kInConst, "ndof", "ndof"}, {kInConst, "limit", "tau_max"}, {kOut, "tau", "tau"}}},
           {"arm", "puma_torque", "1 kHz", "ON",
            {{kIn, "tau", "tau"}, {kOut, "q", "q"}, {kOut, "qd", "qd"}, {kOutConst, "ndof", "ndof"},
             {kResource, "model", "puma560.xml"}}},
           {"log", "csv_log", "10 Hz", "OFF", {{kIn, "a", "q"}, {kIn, "b", "q_d"}, {kResource, "file", "out.csv"}}}},
          {"kp"}};
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(Graph, ColumnsFollowTheDataAndLoopsAreCutBehindTheirSource) {
  EXPECT_EQ(columns_of(figure4()), (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST(Graph, ALoopWithoutSourceStillHasColumns) {
  const Graph loop{"loop", {{"a", "", "", "", {{kIn, "x", "x"}, {kOut, "y", "y"}}},
                            {"b", "", "", "", {{kIn, "y", "y"}, {kOut, "x", "x"}}}}, {}};
  EXPECT_EQ(columns_of(loop), (std::vector<std::size_t>{0, 1}));
}

/// Checks properties of every picture.
void expect_sound(const Graph& graph) {
  const Layout layout = lay_out(graph);
  std::set<int> tracks;
  for (const Piece& piece : layout.pieces) {
    EXPECT_TRUE(piece.x1 == piece.x2 || piece.y1 == piece.y2);
    EXPECT_TRUE(std::min(piece.x1, piece.x2) >= 0 && std::max(piece.x1, piece.x2) <= layout.width);
    EXPECT_TRUE(std::min(piece.y1, piece.y2) >= 0 && std::max(piece.y1, piece.y2) <= layout.height);
    if (piece.x1 == piece.x2 && !piece.is_dot) {
      EXPECT_TRUE(tracks.insert(piece.x1).second) << "two lines share the track at " << piece.x1;
    }
    for (const Placed& box : layout.boxes) {
      const bool beside = std::max(piece.x1, piece.x2) <= box.x || std::min(piece.x1, piece.x2) >= box.x + box.width;
      const bool over = std::max(piece.y1, piece.y2) <= box.y || std::min(piece.y1, piece.y2) >= box.y + box.height;
      EXPECT_TRUE(beside || over) << "a line crosses " << graph.boxes[box.box].name;
    }
  }
  for (const Placed& a : layout.boxes) {
    EXPECT_LE(a.x + a.width, layout.width);
    EXPECT_LE(a.y + a.height, layout.height);
    for (const Placed& b : layout.boxes) {
      const bool apart = a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
      EXPECT_TRUE(&a == &b || apart) << graph.boxes[a.box].name << " lies on " << graph.boxes[b.box].name;
    }
  }
}

TEST(Graph, LinesCrossNoBoxAndShareNoTrack) { expect_sound(figure4()); }

TEST(Graph, AnyGraphIsDrawnSoundly) {
  for (unsigned seed = 1; seed <= 200 && !::testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Graph graph{"random", {}, {"v0", "v1"}};
    const std::size_t boxes = 1 + random() % 8, ports = 1 + random() % 9;
    for (std::size_t i = 0; i < boxes; ++i) {
      Box box{"box" + std::to_string(i), random() % 2 == 0 ? "" : "component", "", "", {}};
      for (std::size_t k = 0; k < ports; ++k) {
        const auto kind = static_cast<PortKind>(random() % 5);
        box.ports.push_back({kind, "p" + std::to_string(k), "v" + std::to_string(random() % 9)});
      }
      graph.boxes.push_back(box);
    }
    expect_sound(graph);
    if (const char* keep = std::getenv("CHIMERA_KEEP_PICTURE"); keep != nullptr) std::ofstream(keep) << svg(graph);
  }
}

TEST(Graph, TheLargestApplicationIsDrawn) {
  Graph graph{"chain", {}, {}};
  for (int i = 0; i < 256; ++i) {
    const std::string in = "v" + std::to_string(i), out = "v" + std::to_string((i + 1) % 256);
    graph.boxes.push_back({"box" + std::to_string(i), "", "", "", {{kIn, "in", in}, {kOut, "out", out}}});
  }
  expect_sound(graph);
  EXPECT_EQ(count(svg(graph), "rx=\"12\""), 256u);
}

TEST(Graph, ADotMarksEveryFan) {
  Graph graph = figure4();
  const auto dots = [&graph] {
    std::size_t n = 0;
    const Layout layout = lay_out(graph);
    for (const Piece& piece : layout.pieces) n += piece.is_dot ? 1 : 0;
    return n;
  };
  const std::size_t with_log = dots();
  graph.boxes.pop_back();
  EXPECT_GE(with_log, 2u);
  EXPECT_EQ(dots(), 0u);
}

TEST(Svg, ShowsEveryNameAndEscapesIt) {
  Graph graph = figure4();
  graph.title = "a<b&c";
  const std::string document = svg(graph);
  for (const char* name : {"trajectory", "pid_joint", "1 kHz ON", "puma560.xml", "tau_max", "a&lt;b&amp;c"}) {
    EXPECT_EQ(count(document, std::string(name)) > 0, true) << name;
  }
  EXPECT_EQ(count(document, "rx=\"12\""), 4u);
  EXPECT_TRUE(document.ends_with("</svg>\n"));
}

TEST(Dot, JoinsPairsDirectlyAndFansThroughADot) {
  const std::string document = dot(figure4());
  EXPECT_EQ(count(document, "\"pid\" -> \"arm\" [label=\"tau\"];"), 1u);
  EXPECT_EQ(count(document, "\"var q\" [shape=point, xlabel=\"q\"];"), 1u);
  EXPECT_EQ(count(document, "\"arm\" -> \"var q\" [arrowhead=none];"), 1u);
  EXPECT_EQ(count(document, "\"var q\" -> \"log\";"), 1u);
  EXPECT_EQ(count(document, "\"var kp\" -> \"pid\";"), 1u);
  EXPECT_EQ(count(document, "label=\"arm\\npuma_torque\\n1 kHz\\nON\""), 1u);
}

TEST(Text, DrawsInputsLeftAndOutputsRight) {
  const Graph graph{"tiny",
                    {{"gain", "gain", "1 kHz", "",
                      {{kIn, "x", "u"}, {kOut, "y", "y"}, {kInConst, "k", "k"}, {kResource, "dev", "/dev/x"}}},
                     {"log", "csv_log", "", "", {{kIn, "a", "y"}}}},
                    {"u"}};
  std::string bar;
  for (int i = 0; i < 26; ++i) bar += "\u2500";
  EXPECT_EQ(text(graph),
            "tiny\n"
            "                                     k \u25bc\n"
            "                                   \u256d" + bar + "\u256e\n"
            "                       u (given) \u2500\u25b6\u2502 gain                     \u2502\u2500\u25b6 y (log)\n"
            "                                   \u2502 1 kHz                    \u2502\n"
            "                                   \u2570" + bar + "\u256f\n"
            "                                     \u2195 dev = /dev/x\n"
            "                                   \u256d" + bar + "\u256e\n"
            "                        y (gain) \u2500\u25b6\u2502 log                      \u2502\n"
            "                                   \u2502 csv_log                  \u2502\n"
            "                                   \u2570" + bar + "\u256f\n");
}

}  // namespace
}  // namespace chimera::draw::graph_test
