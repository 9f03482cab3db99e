// SPDX-License-Identifier: Apache-2.0
// Draws a schedule as an SVG chart: a row for each task, with marks for releases and deadlines.
#include "chimera/draw/gantt.h"

#include <algorithm>
#include <cstdio>

#include "chimera/draw/plot.h"
#include "chimera/draw/svg_text.h"

namespace chimera::draw {
namespace {

constexpr double kNames = 190, kWidth = 720, kRow = 30, kBar = 16, kHead = 58, kFoot = 40, kMargin = 20;
constexpr double kLeft = kMargin + kNames;
constexpr double kLeastApart = 6;        // closer releases are not drawn
constexpr std::size_t kMostLetters = 24;  // of a name

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string label(double x, double y, const std::string& text, const char* style) {
  return format("<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, style) + escaped(text) + "</text>\n";
}

/// A viewer shows the whole name when the pointer is on it.
std::string name_label(double x, double y, const std::string& name) {
  constexpr const char* kStyle = "font-size=\"13\"";
  if (name.size() <= kMostLetters) return label(x, y, name, kStyle);
  return "<g><title>" + escaped(name) + "</title>" + label(x, y, name.substr(0, kMostLetters - 3) + "...", kStyle) +
         "</g>\n";
}

double height_of(const Gantt& picture) { return kHead + kRow * static_cast<double>(picture.rows.size()) + kFoot; }

std::string line(double x1, double y1, double x2, double y2, const char* colour) {
  return format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\"/>\n", x1, y1, x2, y2, colour);
}

class GanttPage {
 public:
  GanttPage(const Gantt& picture, double top) : picture_(picture), top_(top) {}

  std::string draw() {
    said_ = label(kMargin, top_ + 20, picture_.title, "font-size=\"15\" font-weight=\"bold\"");
    said_ += label(kMargin, top_ + 40, picture_.note, "font-size=\"12\" fill=\"#555\"");
    axis();
    for (std::size_t i = 0; i < picture_.rows.size(); ++i)
      row(picture_.rows[i], top_ + kHead + kRow * static_cast<double>(i));
    return std::move(said_);
  }

 private:
  double x(Nanoseconds at) const {
    const auto whole = static_cast<double>(std::max<std::int64_t>(picture_.length.count, 1));
    return kLeft + kWidth * static_cast<double>(at.count) / whole;
  }

  void axis() {
    const double foot = top_ + kHead + kRow * static_cast<double>(picture_.rows.size());
    const double ms = static_cast<double>(picture_.length.count) * 1e-6;
    for (const double mark : axis_marks(0, ms, 8)) {
      const double at = kLeft + kWidth * mark / ms;
      said_ += line(at, top_ + kHead - 4, at, foot, "#ddd");
      said_ += label(at, foot + 16, format("%g", mark), "font-size=\"11\" text-anchor=\"middle\" fill=\"#555\"");
    }
    said_ += label(kMargin, foot + 32, "arrow: released; dashed: due; red bar: its deadline is not guaranteed",
                   "font-size=\"10\" fill=\"#555\"");
    said_ += label(kLeft + kWidth, foot + 32, "ms", "font-size=\"11\" text-anchor=\"end\" fill=\"#555\"");
  }

  void row(const GanttRow& row, double y) {
    const char* colour = row.is_late ? "#c0392b" : "#2874a6";
    said_ += name_label(kMargin, y + 12, row.name);
    said_ += label(kMargin, y + 25, row.note, "font-size=\"10\" fill=\"#555\"");
    said_ += line(kLeft, y + kBar + 4, kLeft + kWidth, y + kBar + 4, "#bbb");
    for (const auto& [from, to] : row.runs)
      said_ += format("<rect x=\"%.2f\" y=\"%.1f\" width=\"%.2f\" height=\"%.0f\" fill=\"%s\"/>\n", x(from), y + 4,
                      std::max(x(to) - x(from), 0.5), kBar, colour);
    if (row.period.count <= 0 || x(row.period) - kLeft < kLeastApart) return;
    for (Nanoseconds at; at <= picture_.length; at += row.period) {
      constexpr const char* kArrow = "<path d=\"M%.1f %.1fv-22m-3 5l3 -5l3 5\" fill=\"none\" stroke=\"#333\"/>\n";
      constexpr const char* kDue = "<path d=\"M%.1f %.1fv-18\" stroke=\"#c0392b\" stroke-dasharray=\"3 2\"/>\n";
      said_ += format(kArrow, x(at), y + kBar + 4);
      if (at + row.deadline <= picture_.length) said_ += format(kDue, x(at + row.deadline), y + kBar + 8);
    }
  }

  const Gantt& picture_;
  double top_;
  std::string said_;
};

}  // namespace

std::string svg(const std::vector<Gantt>& pictures) {
  double height = 0;
  for (const Gantt& picture : pictures) height += height_of(picture);
  const double width = kMargin * 2 + kNames + kWidth;
  std::string all = format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
                           "font-family=\"sans-serif\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
                           width, height);
  double top = 0;
  for (const Gantt& picture : pictures) {
    all += GanttPage(picture, top).draw();
    top += height_of(picture);
  }
  return all + "</svg>\n";
}

}  // namespace chimera::draw
