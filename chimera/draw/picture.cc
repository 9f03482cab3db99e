// SPDX-License-Identifier: Apache-2.0
// Writes the layout of a graph as JSON.
#include "chimera/draw/picture.h"

#include "chimera/draw/layout.h"
#include "chimera/load/descriptor.h"

namespace chimera::draw {
namespace {

std::string_view kind_word(PortKind kind) {
  constexpr std::uint32_t kKinds[] = {CHIMERA_IN_VAR, CHIMERA_OUT_VAR, CHIMERA_IN_CONST, CHIMERA_OUT_CONST,
                                      CHIMERA_RESOURCE};
  return kind_name(kKinds[static_cast<unsigned>(kind)]);
}

Json or_null(std::string_view text) { return text.empty() ? Json() : Json(text); }

}  // namespace

Json picture_json(const Graph& graph) {
  const Layout layout = lay_out(graph);
  Json boxes = Json::array(), ports = Json::array(), lines = Json::array(), dots = Json::array(),
       labels = Json::array();
  for (const PlacedBox& box : layout.boxes)
    boxes.push_back({{"task", box.task}, {"x", box.x}, {"y", box.y}, {"width", box.width}, {"height", box.height}});
  for (const PlacedPort& each : layout.ports)
    ports.push_back({{"task", each.task},
                     {"port", each.port->name},
                     {"kind", kind_word(each.port->kind)},
                     {"variable", or_null(each.port->variable)},
                     {"x", each.x},
                     {"y", each.y}});
  for (const Piece& piece : layout.lines)
    lines.push_back({{"variable", or_null(piece.variable)},
                     {"x1", piece.x1},
                     {"y1", piece.y1},
                     {"x2", piece.x2},
                     {"y2", piece.y2},
                     {"arrow", piece.arrow}});
  for (const Dot& dot : layout.dots) dots.push_back({{"variable", dot.variable}, {"x", dot.x}, {"y", dot.y}});
  for (const Label& label : layout.labels)
    labels.push_back({{"text", label.text},
                      {"x", label.x},
                      {"y", label.y},
                      {"style", label.style},
                      {"anchor", label.anchor},
                      {"task", or_null(label.task)},
                      {"variable", or_null(label.variable)}});
  return {{"title", layout.title},      {"width", layout.width},      {"height", layout.height},
          {"boxes", std::move(boxes)},  {"ports", std::move(ports)},  {"lines", std::move(lines)},
          {"dots", std::move(dots)},    {"labels", std::move(labels)}};
}

}  // namespace chimera::draw
