// SPDX-License-Identifier: Apache-2.0
#include "chimera/draw/graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <random>

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
             {kResource, "model", "", "puma560.xml"}}},
           {"log", "csv_log", "10 Hz", "OFF",
            {{kIn, "a", "q"}, {kIn, "b", "q_d"}, {kResource, "file", "", "out.csv"}}}},
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

struct Area {
  int left, top, right, bottom;
  bool meets(const Area& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

Area area(const PlacedBox& box) { return {box.x, box.y, box.x + box.width, box.y + box.height}; }

/// The letters of a label stand on its base line; those of the title are larger.
Area area(const Label& label) {
  const bool is_title = std::string_view(label.style) == "title";
  const int width = width_of(label.text) * (is_title ? 3 : 2) / 2;
  const int begin = std::string_view(label.anchor) == "start" ? 0 : std::string_view(label.anchor) == "end" ? 2 : 1;
  return {label.x - width * begin / 2, label.y - 9, label.x + width - width * begin / 2, label.y + 2};
}

Area area(const Piece& piece) {
  const auto [left, right] = std::minmax(piece.x1, piece.x2);
  const auto [top, bottom] = std::minmax(piece.y1, piece.y2);
  return {left, top, right, bottom};
}

/// True if the pieces have more than a point in common.
bool lies_on(const Piece& a, const Piece& b) {
  const Area one = area(a), two = area(b);
  const int width = std::min(one.right, two.right) - std::max(one.left, two.left);
  const int height = std::min(one.bottom, two.bottom) - std::max(one.top, two.top);
  return width >= 0 && height >= 0 && width + height > 0;
}

void expect_lines_apart(const Layout& layout) {
  for (const Piece& piece : layout.lines) {
    const Area line = area(piece);
    EXPECT_TRUE(piece.x1 == piece.x2 || piece.y1 == piece.y2);
    EXPECT_TRUE(line.left >= 0 && line.right <= layout.width && line.top >= 0 && line.bottom <= layout.height);
    for (const PlacedBox& box : layout.boxes) EXPECT_FALSE(area(piece).meets(area(box))) << "crosses " << box.task;
    for (const Piece& other : layout.lines)
      EXPECT_FALSE(piece.variable != other.variable && lies_on(piece, other))
          << piece.variable << " lies on " << other.variable;
  }
}

void expect_words_apart(const Layout& layout) {
  for (const Label& a : layout.labels) {
    EXPECT_TRUE(area(a).left >= 0 && area(a).right <= layout.width) << a.text;
    for (const Label& b : layout.labels)
      EXPECT_FALSE(&a < &b && std::string_view(a.style) == b.style && area(a).meets(area(b)))
          << a.text << " lies on " << b.text;
  }
  for (const PlacedPort& port : layout.ports) {
    if (port.port->kind != kOut || port.port->variable.empty()) continue;
    const Area value{port.x + 4, port.y + 1, port.x + kValueRoom, port.y + 11};
    for (const Label& label : layout.labels) EXPECT_FALSE(area(label).meets(value)) << label.text;
    for (const Piece& piece : layout.lines) EXPECT_FALSE(area(piece).meets(value)) << piece.variable;
  }
}

/// The lines of a variable join each of its inputs to each of its outputs.
void expect_joined(const Layout& layout) {
  for (const PlacedPort& from : layout.ports) {
    if (from.port->kind != kOut || from.port->variable.empty()) continue;
    std::vector<Piece> left;
    for (const Piece& piece : layout.lines)
      if (piece.variable == from.port->variable) left.push_back(piece);
    std::vector<Area> reached{{from.x, from.y, from.x, from.y}};
    const auto touches = [](const Area& a, const Area& b) {
      return a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;
    };
    for (std::size_t i = 0; i < reached.size(); ++i)
      std::erase_if(left, [&](const Piece& piece) {
        if (!touches(area(piece), reached[i])) return false;
        reached.push_back(area(piece));
        return true;
      });
    for (const PlacedPort& to : layout.ports) {
      if (to.port->kind != kIn || to.port->variable != from.port->variable) continue;
      const Area end{to.x, to.y, to.x, to.y};
      EXPECT_TRUE(std::ranges::any_of(reached, [&](const Area& one) { return touches(one, end); })) << to.task;
    }
  }
}

/// Checks properties of every picture.
void expect_sound(const Graph& graph) {
  const Layout layout = lay_out(graph);
  EXPECT_EQ(layout.boxes.size(), graph.boxes.size());
  for (const PlacedBox& a : layout.boxes) {
    EXPECT_LE(a.x + a.width, layout.width);
    EXPECT_LE(a.y + a.height, layout.height);
    for (const PlacedBox& b : layout.boxes)
      EXPECT_TRUE(&a == &b || !area(a).meets(area(b))) << a.task << " lies on " << b.task;
  }
  expect_lines_apart(layout);
  expect_words_apart(layout);
  expect_joined(layout);
}

TEST(Graph, LinesCrossNoBoxAndNoWords) { expect_sound(figure4()); }

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
  EXPECT_GE(lay_out(graph).dots.size(), 2u);
  graph.boxes.pop_back();
  EXPECT_EQ(lay_out(graph).dots.size(), 0u);
}

TEST(Graph, BoxesStandInTheOrderInWhichNoLinesCross) {
  Graph graph{"pairs", {}, {}};
  const std::string names = "abcdef";
  for (const char name : names)
    graph.boxes.push_back({std::string("from_") + name, "", "", "", {{kOut, "y", std::string(1, name)}}});
  for (const char name : {'d', 'a', 'f', 'c', 'e', 'b'})
    graph.boxes.push_back({std::string("to_") + name, "", "", "", {{kIn, "x", std::string(1, name)}}});
  EXPECT_EQ(crossings(lay_out(graph).lines), 0u);
}

TEST(Graph, TracksStandInTheOrderInWhichNoLinesCross) {
  Graph graph{"down", {{"from", "", "", "", {{kOut, "a", "a"}, {kOut, "b", "b"}, {kOut, "c", "c"}}},
                       {"to", "", "", "", {{kIn, "p", "p"}, {kIn, "q", "q"}, {kIn, "r", "r"}, {kIn, "a", "a"},
                                           {kIn, "b", "b"}, {kIn, "c", "c"}}}}, {"p", "q", "r"}};
  EXPECT_EQ(crossings(lay_out(graph).lines), 0u);
}

TEST(Graph, CrossingsAreCountedBetweenVariablesOnly) {
  const std::vector<Piece> lines{{"a", 0, 5, 10, 5}, {"b", 5, 0, 5, 10}, {"a", 6, 0, 6, 10}, {"b", 10, 0, 10, 10}};
  EXPECT_EQ(crossings(lines), 1u);
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

TEST(Svg, HasNoLabelForAnEmptyTitle) {
  Graph graph = figure4();
  graph.title = "";
  for (const Label& label : lay_out(graph).labels) EXPECT_NE(label.text, "");
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
                      {{kIn, "x", "u"}, {kOut, "y", "y"}, {kInConst, "k", "k"}, {kResource, "dev", "", "/dev/x"}}},
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
            "                                     \u2195 dev\n"
            "                                   \u256d" + bar + "\u256e\n"
            "                        y (gain) \u2500\u25b6\u2502 log                      \u2502\n"
            "                                   \u2502 csv_log                  \u2502\n"
            "                                   \u2570" + bar + "\u256f\n");
}

}  // namespace
}  // namespace chimera::draw::graph_test
