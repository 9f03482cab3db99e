// SPDX-License-Identifier: Apache-2.0
// A picture of an application the papers' way: rounded boxes, inputs left, outputs right, constants on top,
// resources below, dots where one line fans out (1994 paper, figures 2 to 4).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace chimera::draw {

enum class PortKind : std::uint8_t { kIn, kOut, kInConst, kOutConst, kResource };

/// A port of a box. Ports with the same `variable` are joined by a line, from the outputs to the inputs.
struct Port {
  PortKind kind = PortKind::kIn;
  std::string name;
  std::string variable;  ///< a resource: what it stands for; empty: joined to nothing
};

/// A task.
struct Box {
  std::string name;
  std::string component;  ///< left out of the picture when it is the name
  std::string rate;       ///< as text, "1 kHz"; may be empty
  std::string state;      ///< "ON"; may be empty
  std::vector<Port> ports;
};

struct Graph {
  std::string title;
  std::vector<Box> boxes;
  std::vector<std::string> given;  ///< variables that no box makes: the operator or the file does
};

/// The graph for Graphviz. Context: setup.
std::string dot(const Graph& graph);
/// A whole SVG document, laid out here: layers by data flow, lines that go back run below. Context: setup.
std::string svg(const Graph& graph);
/// Lines of at most 100 columns for a terminal. Context: setup.
std::string text(const Graph& graph);

}  // namespace chimera::draw
