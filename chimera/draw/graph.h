// SPDX-License-Identifier: Apache-2.0
// A picture of an application in the style of the papers: rounded boxes, inputs left, outputs right, constants on top,
// resources below, dots where a line branches (1994 paper, figures 2 to 4).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace chimera::draw {

enum class PortKind : std::uint8_t { kIn, kOut, kInConst, kOutConst, kResource };

/// A port of a box. A line joins ports with the same `variable`, from the outputs to the inputs.
struct Port {
  PortKind kind = PortKind::kIn;
  std::string name;
  std::string variable;      ///< empty: not linked; a resource never is
  std::string written = {};  ///< value in the file, of a resource or an unlinked constant; may be empty
  bool is_drawn = true;      ///< false: only text() has it
};

/// A task.
struct Box {
  std::string name;
  std::string component;  ///< omitted from the picture if equal to the name
  std::string rate;       ///< as text, "1 kHz"; may be empty
  std::string state;      ///< "ON"; may be empty
  std::vector<Port> ports;
};

struct Graph {
  std::string title;
  std::vector<Box> boxes;
  std::vector<std::string> given;  ///< variables from the operator or the file
};

/// The graph for Graphviz. Context: setup.
std::string dot(const Graph& graph);
/// A whole SVG document with its layout: layers by data flow; lines that go back run below. Context: setup.
std::string svg(const Graph& graph);
/// Lines of at most 100 columns for a terminal. Context: setup.
std::string text(const Graph& graph);

}  // namespace chimera::draw
