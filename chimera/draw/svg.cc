// SPDX-License-Identifier: Apache-2.0
// Writes the layout of a graph as an SVG document.
#include "chimera/draw/layout.h"
#include "chimera/draw/svg_text.h"

namespace chimera::draw {
namespace {

/// ` NAME="VALUE"`.
std::string at(const char* name, int value) {
  return std::string(" ") + name + "=\"" + std::to_string(value) + "\"";
}

std::string head(int width, int height) {
  const std::string w = std::to_string(width), h = std::to_string(height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h + "\" viewBox=\"0 0 " + w + " " +
         h +
         "\">\n<style>text{font:11px \"DejaVu Sans Mono\",monospace;fill:#222}.title{font-size:15px;"
         "font-weight:bold}.name{font-size:12px;font-weight:bold}.soft{fill:#555}.given{fill:#06c}"
         "rect{fill:#f5f7fa;stroke:#234;stroke-width:1.5}line{stroke:#234;stroke-width:1.2}"
         "circle{fill:#234}#a path{fill:#234}</style>\n"
         "<defs><marker id=\"a\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" "
         "orient=\"auto-start-reverse\"><path d=\"M0,0 L8,4 L0,8 z\"/></marker></defs>\n"
         "<rect x=\"0\" y=\"0\" width=\"100%\" height=\"100%\" style=\"fill:#fff;stroke:none\"/>\n";
}

std::string arrows(std::string_view arrow) {
  std::string marks;
  if (arrow == "end" || arrow == "both") marks += " marker-end=\"url(#a)\"";
  if (arrow == "start" || arrow == "both") marks += " marker-start=\"url(#a)\"";
  return marks;
}

}  // namespace

std::string svg(const Graph& graph) {
  const Layout layout = lay_out(graph);
  std::string out = head(layout.width, layout.height);
  for (const Piece& p : layout.lines)
    out += "<line" + at("x1", p.x1) + at("y1", p.y1) + at("x2", p.x2) + at("y2", p.y2) + arrows(p.arrow) + "/>\n";
  for (const Dot& dot : layout.dots) out += "<circle" + at("cx", dot.x) + at("cy", dot.y) + " r=\"3\"/>\n";
  for (const PlacedBox& box : layout.boxes)
    out += "<rect" + at("x", box.x) + at("y", box.y) + at("width", box.width) + at("height", box.height) +
           " rx=\"12\"/>\n";
  for (const Label& label : layout.labels)
    out += "<text" + at("x", label.x) + at("y", label.y) + " class=\"" + label.style + "\" text-anchor=\"" +
           label.anchor + "\">" + escaped(label.text) + "</text>\n";
  return out + "</svg>\n";
}

}  // namespace chimera::draw
