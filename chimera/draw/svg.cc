// SPDX-License-Identifier: Apache-2.0
// Draws a graph of tasks as an SVG picture, after layout and routing.
#include <algorithm>

#include "chimera/draw/graph.h"
#include "chimera/draw/layout.h"
#include "chimera/draw/svg_text.h"

namespace chimera::draw {
namespace {

std::string n(int value) { return std::to_string(value); }

/// A document under construction.
class SvgPage {
 public:
  void words(int x, int y, const std::string& what, const char* style, const char* anchor = "start") {
    body_ += "<text x=\"" + n(x) + "\" y=\"" + n(y) + "\" class=\"" + style + "\" text-anchor=\"" + anchor + "\">" +
             escaped(what) + "</text>\n";
  }
  void line(int x1, int y1, int x2, int y2, const std::string& more = "") {
    body_ += "<line x1=\"" + n(x1) + "\" y1=\"" + n(y1) + "\" x2=\"" + n(x2) + "\" y2=\"" + n(y2) + "\"" + more +
             "/>\n";
  }
  void dot(int x, int y) { body_ += "<circle cx=\"" + n(x) + "\" cy=\"" + n(y) + "\" r=\"3\"/>\n"; }
  void box(const Placed& p) {
    body_ += "<rect x=\"" + n(p.x) + "\" y=\"" + n(p.y) + "\" width=\"" + n(p.width) + "\" height=\"" + n(p.height) +
             "\" rx=\"12\"/>\n";
  }
  std::string document(int width, int height) const {
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + n(width) + "\" height=\"" + n(height) +
           "\" viewBox=\"0 0 " + n(width) + " " + n(height) +
           "\">\n<style>text{font:11px \"DejaVu Sans Mono\",monospace;fill:#222}.title{font-size:15px;"
           "font-weight:bold}.name{font-size:12px;font-weight:bold}.soft{fill:#555}.given{fill:#06c}"
           "rect{fill:#f5f7fa;stroke:#234;stroke-width:1.5}line{stroke:#234;stroke-width:1.2}"
           "circle{fill:#234}#a path{fill:#234}</style>\n"
           "<defs><marker id=\"a\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" "
           "orient=\"auto-start-reverse\"><path d=\"M0,0 L8,4 L0,8 z\"/></marker></defs>\n"
           "<rect x=\"0\" y=\"0\" width=\"100%\" height=\"100%\" style=\"fill:#fff;stroke:none\"/>\n" +
           body_ + "</svg>\n";
  }

 private:
  std::string body_;
};

constexpr const char* kArrow = " marker-end=\"url(#a)\"";
constexpr const char* kBackArrow = " marker-start=\"url(#a)\"";

/// The name of a port and, if it differs, its link.
std::string link_text(const Port& port, const char* between) {
  return port.variable.empty() || port.variable == port.name ? port.name : port.name + between + port.variable;
}

void draw_above(SvgPage& page, const Placed& p) {
  // The leftmost line is the longest, so that its label runs over all others.
  for (std::size_t i = 0; i < p.above.size(); ++i) {
    const int x = p.x + static_cast<int>(i + 1) * kStep;
    const int top = p.y - 6 - static_cast<int>(p.above.size() - i) * kStep;
    page.line(x, top, x, p.y, p.above[i]->kind == PortKind::kInConst ? kArrow : kBackArrow);
    page.words(x + 4, top + 6, link_text(*p.above[i], "="), "soft");
  }
}

void draw_below(SvgPage& page, const Placed& p) {
  for (std::size_t i = 0; i < p.below.size(); ++i) {
    const int x = p.x + static_cast<int>(i + 1) * kStep;
    const int bottom = p.y + p.height + 6 + static_cast<int>(p.below.size() - i) * kStep;
    page.line(x, p.y + p.height, x, bottom, std::string(kArrow) + kBackArrow);
    page.words(x + 4, bottom + 2, link_text(*p.below[i], ": "), "soft");
  }
}

void draw_box(SvgPage& page, const Graph& graph, const Placed& p) {
  page.box(p);
  const std::vector<std::string> head = head_of(graph.boxes[p.box]);
  for (std::size_t i = 0; i < head.size(); ++i) {
    page.words(p.x + p.width / 2, p.y + 18 + static_cast<int>(i) * 16, head[i], i == 0 ? "name" : "soft", "middle");
  }
  for (std::size_t i = 0; i < p.in.size(); ++i) {
    page.words(p.x + 8, p.in_y(i) + 4, p.in[i]->name, "port");
    const std::string& variable = p.in[i]->variable;
    const bool is_given = std::find(graph.given.begin(), graph.given.end(), variable) != graph.given.end();
    if (is_given) page.words(p.x - kStub - 4, p.in_y(i) + 4, variable, "given", "end");
  }
  for (std::size_t i = 0; i < p.out.size(); ++i) {
    page.words(p.x + p.width - 8, p.out_y(i) + 4, p.out[i]->name, "port", "end");
    page.words(p.x + p.width + 4, p.out_y(i) - 5, p.out[i]->variable, "soft");
  }
  draw_above(page, p);
  draw_below(page, p);
}

}  // namespace

std::string svg(const Graph& graph) {
  const Layout layout = lay_out(graph);
  SvgPage page;
  page.words(24, 26, graph.title, "title");
  for (const Piece& piece : layout.pieces) {
    if (piece.is_dot) page.dot(piece.x1, piece.y1);
    else page.line(piece.x1, piece.y1, piece.x2, piece.y2, piece.has_arrow ? kArrow : "");
  }
  for (const Placed& placed : layout.boxes) draw_box(page, graph, placed);
  return page.document(std::max(layout.width, width_of(graph.title) * 3 / 2 + 48), layout.height);
}

}  // namespace chimera::draw
