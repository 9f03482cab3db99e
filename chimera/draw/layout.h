// SPDX-License-Identifier: Apache-2.0
// A picture of a graph as places of all that is drawn. Boxes form columns by data flow, with one vertical track per
// line between columns. Each line that goes back or over a column has a horizontal lane below all boxes. Lengths in
// pixels from the top left corner.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/draw/graph.h"

namespace chimera::draw {

inline constexpr int kLetter = 7;      ///< width reserved for a letter
inline constexpr int kValueRoom = 66;  ///< width below the line of a linked output that is left free for its value

inline int width_of(const std::string& text) { return static_cast<int>(text.size()) * kLetter; }

struct PlacedBox {
  std::string_view task;
  int x = 0, y = 0, width = 0, height = 0;
};

/// The place where the line of a port meets its box.
struct PlacedPort {
  std::string_view task;
  const Port* port = nullptr;
  int x = 0, y = 0;
};

/// A straight piece of a line, horizontal or vertical.
struct Piece {
  std::string_view variable;  ///< empty: the port is not linked
  int x1 = 0, y1 = 0, x2 = 0, y2 = 0;
  const char* arrow = "";  ///< "", "end", "start" or "both"
};

/// A place where three pieces of a variable meet.
struct Dot {
  std::string_view variable;
  int x = 0, y = 0;
};

struct Label {
  std::string text;
  int x = 0, y = 0;            ///< of the base line, at the anchor
  const char* style = "soft";  ///< "title", "name", "soft", "port" or "given"
  const char* anchor = "start";  ///< "start", "middle" or "end"
  std::string_view task = {}, variable = {};  ///< what the text is about; each may be empty
};

struct Layout {
  std::string_view title;
  std::vector<PlacedBox> boxes;
  std::vector<PlacedPort> ports;
  std::vector<Piece> lines;
  std::vector<Dot> dots;
  std::vector<Label> labels;
  int width = 0, height = 0;
};

/// The layers of `graph`: a box lies right of all boxes that feed it, except over lines that close a loop. Context:
/// setup.
std::vector<std::size_t> columns_of(const Graph& graph);

/// The order of the boxes in each column is the best of several by crossings, then by the length of all lines. Takes
/// less than 10 ms for 100 tasks. Requires: the graph outlives the layout. Context: setup.
Layout lay_out(const Graph& graph);

/// Number of places where a horizontal and a vertical piece of different variables cross. Context: setup.
std::size_t crossings(const std::vector<Piece>& lines);

/// The lines of text inside a box: name, component if it differs, rate and state.
std::vector<std::string> head_of(const Box& box);

}  // namespace chimera::draw
