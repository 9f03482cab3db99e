// SPDX-License-Identifier: Apache-2.0
// Draws curves as SVG panels with axes, linear or logarithmic.
#include "chimera/base/hosted/wording.h"
#include "chimera/draw/plot.h"
#include "chimera/draw/svg_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace chimera::draw {
namespace {

constexpr double kWidth = 960, kLeft = 78, kRight = 22, kTop = 58, kPanel = 210, kLegendRow = 20, kBetween = 16;
constexpr double kInner = kWidth - kLeft - kRight;
// Colours that people with any colour vision can distinguish (Okabe and Ito), without yellow, which is faint on white.
constexpr const char* kColours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000"};
constexpr const char* kDashes[] = {"", "7 3", "2 3"};  // from the eighth curve of a panel on

struct ValueRange {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  bool is_empty() const { return low > high; }
  void take(double x) {
    if (!std::isfinite(x)) return;
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

struct Panel {
  std::string unit;
  int number = 0;
  std::vector<const Curve*> curves;
  ValueRange values;
  double top = 0;
  std::size_t legend_rows = 0;
};

std::string number(double value) {
  std::string trimmed = formatted("%.2f", value);
  trimmed.erase(trimmed.find_last_not_of('0') + 1);
  if (trimmed.back() == '.') trimmed.pop_back();
  return trimmed == "-0" ? "0" : trimmed;
}

std::string label(double value) { return formatted("%.6g", value); }

ValueRange with_margin(ValueRange span, double share) {
  if (span.is_empty()) return {0, 1};
  double room = (span.high - span.low) * share;
  if (room <= 0) room = share == 0 ? 0.5 : std::max(std::fabs(span.high) * 0.1, 1e-9);  // a constant lies in the middle
  return {span.low - room, span.high + room};
}

std::vector<Panel> panels_of(const Plot& plot) {
  std::vector<Panel> panels;
  for (const Curve& curve : plot.curves) {
    const auto same = [&](const Panel& p) { return p.unit == curve.unit && p.number == curve.panel; };
    auto panel = std::find_if(panels.begin(), panels.end(), same);
    if (panel == panels.end()) panel = panels.insert(panels.end(), Panel{curve.unit, curve.panel, {}, {}});
    panel->curves.push_back(&curve);
    for (const PlotPoint& point : curve.points) panel->values.take(point.value);
  }
  if (panels.empty()) panels.push_back({"1", 0, {}, {}});
  double top = kTop + (plot.note.empty() ? 0 : 16);
  for (Panel& panel : panels) {
    if (panel.unit == plot.level_unit) panel.values.take(plot.level);
    panel.values = with_margin(panel.values, 0.06);
    double at = 0;
    panel.legend_rows = panel.curves.empty() ? 0 : 1;
    for (const Curve* curve : panel.curves) {
      const double wide = 40 + 7.3 * static_cast<double>(curve->name.size());
      if (at > 0 && at + wide > kInner) at = 0, ++panel.legend_rows;
      at += wide;
    }
    panel.top = top + kLegendRow * static_cast<double>(panel.legend_rows);
    top = panel.top + kPanel + kBetween;
  }
  return panels;
}

/// A picture under construction.
class PlotPage {
 public:
  explicit PlotPage(const Plot& plot) : plot_(plot), panels_(panels_of(plot)) {
    ValueRange times;
    for (const Curve& curve : plot.curves)
      for (const PlotPoint& point : curve.points) times.take(point.at);
    for (const PlotGap& gap : plot.gaps) times.take(gap.from), times.take(gap.to);
    const ValueRange nothing = plot.is_over_frequency ? ValueRange{1, 10} : ValueRange{0, 1};
    times_ = times.is_empty() ? nothing : times.low == times.high ? with_margin(times, 0) : times;
  }

  std::string document() {
    head();
    for (std::size_t i = 0; i < panels_.size(); ++i) draw(panels_[i], i, i + 1 == panels_.size());
    return body_ + "</svg>\n";
  }

 private:
  double x(double at) const {
    const double share = plot_.is_over_frequency ? std::log(at / times_.low) / std::log(times_.high / times_.low)
                                                 : (at - times_.low) / (times_.high - times_.low);
    return kLeft + share * kInner;
  }
  static double y(const Panel& panel, double value) {
    const double share = (value - panel.values.low) / (panel.values.high - panel.values.low);
    return panel.top + kPanel * (1 - share);
  }
  void words(double at_x, double at_y, const std::string& text, const char* style, const char* anchor) {
    body_ += "<text x=\"" + number(at_x) + "\" y=\"" + number(at_y) + "\" class=\"" + style + "\" text-anchor=\"" +
             anchor + "\">" + escaped(text) + "</text>\n";
  }
  void line(double x1, double y1, double x2, double y2, const char* style) {
    body_ += "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" + number(y2) +
             "\" class=\"" + style + "\"/>\n";
  }
  void rectangle(double left, double top, double width, double height, const std::string& more) {
    body_ += "<rect x=\"" + number(left) + "\" y=\"" + number(top) + "\" width=\"" + number(width) + "\" height=\"" +
             number(height) + "\" " + more + "/>\n";
  }

  void head() {
    const std::string height = number(panels_.back().top + kPanel + 46);
    body_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(kWidth) + "\" height=\"" + height +
            "\" viewBox=\"0 0 " + number(kWidth) + " " + height +
            "\">\n<style>text{font:12px \"DejaVu Sans\",sans-serif;fill:#222}.title{font-size:15px;font-weight:bold}"
            ".note{fill:#555}.mark{font-size:11px;fill:#444}.lost{font-size:11px;fill:#a00}"
            ".grid{stroke:#e4e7ec}.zero{stroke:#98a2b3}.trigger{stroke:#a00;stroke-dasharray:5 4}"
            ".curve{fill:none;stroke-width:1.5;stroke-linejoin:round}</style>\n"
            "<defs><pattern id=\"gap\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" "
            "patternTransform=\"rotate(45)\"><rect width=\"6\" height=\"6\" fill=\"#fdecea\"/>"
            "<line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"6\" stroke=\"#e8a09a\" stroke-width=\"2\"/></pattern>\n";
    for (std::size_t i = 0; i < panels_.size(); ++i)
      body_ += "<clipPath id=\"panel" + std::to_string(i) + "\"><rect x=\"" + number(kLeft) + "\" y=\"" +
               number(panels_[i].top) + "\" width=\"" + number(kInner) + "\" height=\"" + number(kPanel) +
               "\"/></clipPath>\n";
    body_ += "</defs>\n";
    rectangle(0, 0, kWidth, panels_.back().top + kPanel + 46, "fill=\"#fff\"");
    words(kLeft, 26, plot_.title, "title", "start");
    if (!plot_.note.empty()) words(kLeft, 44, plot_.note, "note", "start");
  }

  std::string across() const {
    if (!plot_.across.empty()) return plot_.across;
    return plot_.is_over_frequency ? "frequency [Hz]" : "time [s]";
  }

  void legend(const Panel& panel) {
    double at = kLeft, row = panel.top - 8 - kLegendRow * static_cast<double>(panel.legend_rows - 1);
    for (std::size_t i = 0; i < panel.curves.size(); ++i) {
      const double wide = 40 + 7.3 * static_cast<double>(panel.curves[i]->name.size());
      if (at > kLeft && at + wide > kLeft + kInner) at = kLeft, row += kLegendRow;
      body_ += "<path d=\"M" + number(at) + "," + number(row - 4) + " h20\" " + style(i) + "/>\n";
      words(at + 25, row, panel.curves[i]->name, "", "start");
      at += wide;
    }
  }

  void gaps(const Panel& panel, bool with_text) {
    for (const PlotGap& gap : plot_.gaps) {
      const double left = x(gap.from), wide = std::max(x(gap.to) - left, 2.0);
      rectangle(left, panel.top, wide, kPanel, "fill=\"url(#gap)\"");
      if (!with_text) continue;
      const bool is_right = left > kLeft + kInner * 0.7;
      words(is_right ? left - 4 : left + wide + 4, panel.top + 14, gap.text, "lost", is_right ? "end" : "start");
    }
  }

  void axes(const Panel& panel, bool with_times) {
    const double bottom = panel.top + kPanel;
    for (const double value : axis_marks(panel.values.low, panel.values.high, 5)) {
      line(kLeft, y(panel, value), kLeft + kInner, y(panel, value), value == 0 ? "zero" : "grid");
      words(kLeft - 7, y(panel, value) + 4, label(value), "mark", "end");
    }
    const bool is_log = plot_.is_over_frequency;
    for (const double at : is_log ? decade_marks(times_.low, times_.high) : axis_marks(times_.low, times_.high, 9)) {
      line(x(at), panel.top, x(at), bottom, "grid");
      if (with_times) words(x(at), bottom + 17, label(at), "mark", "middle");
    }
    if (with_times) words(kLeft + kInner / 2, bottom + 36, across(), "", "middle");
    const std::string middle = number(panel.top + kPanel / 2);
    const std::string text = panel.unit == "1" ? "[1]" : "[" + panel.unit + "]";
    body_ += "<text x=\"18\" y=\"" + middle + "\" text-anchor=\"middle\" transform=\"rotate(-90 18 " + middle + ")\">" +
             escaped(text) + "</text>\n";
  }

  void draw(const Panel& panel, std::size_t index, bool is_last) {
    legend(panel);
    axes(panel, is_last);
    gaps(panel, index == 0);
    if (panel.unit == plot_.level_unit && std::isfinite(plot_.level))
      line(kLeft, y(panel, plot_.level), kLeft + kInner, y(panel, plot_.level), "trigger");
    if (plot_.mark && *plot_.mark >= times_.low && *plot_.mark <= times_.high)
      line(x(*plot_.mark), panel.top, x(*plot_.mark), panel.top + kPanel, "trigger");
    body_ += "<g clip-path=\"url(#panel" + std::to_string(index) + ")\">\n";
    bool is_drawn = false;
    for (std::size_t i = 0; i < panel.curves.size(); ++i) is_drawn = draw(panel, *panel.curves[i], i) || is_drawn;
    body_ += "</g>\n";
    if (!is_drawn) words(kLeft + kInner / 2, panel.top + kPanel / 2, "no values", "note", "middle");
    rectangle(kLeft, panel.top, kInner, kPanel, "fill=\"none\" stroke=\"#667085\"");
  }

  /// Draws one curve as strokes; false if it has no finite value.
  bool draw(const Panel& panel, const Curve& curve, std::size_t index) {
    std::string path;
    bool is_down = false, is_drawn = false;
    double held_y = 0;
    const auto to = [&](double px, double py) {
      if (curve.is_held && is_down && py != held_y) path += " L" + number(px) + "," + number(held_y);
      held_y = py;
      path += (is_down ? " L" : " M") + number(px) + "," + number(py);
      is_drawn = is_down = true;
    };
    for (std::size_t i = 0; i < curve.points.size();) {
      if (!std::isfinite(curve.points[i].value)) is_down = false, ++i;
      else i = column(panel, curve, i, to);
    }
    // A single point is a line of length 0; its round ends make it a dot.
    body_ += is_drawn ? "<path d=\"" + path.substr(1) + "\" stroke-linecap=\"round\" " + style(index) + "/>\n" : "";
    for (const PlotPoint& point : curve.points)
      if (curve.has_marks && std::isfinite(point.value))
        body_ += "<circle cx=\"" + number(x(point.at)) + "\" cy=\"" + number(y(panel, point.value)) + "\" r=\"3\" " +
                 style(index) + "/>\n";
    return is_drawn;
  }

  /// Draws the points from `i` on that fall into one column of the picture: at most first, least, greatest and last.
  template <class To>
  std::size_t column(const Panel& panel, const Curve& curve, std::size_t i, const To& to) const {
    const double left = std::floor(x(curve.points[i].at));
    std::size_t end = i, least = i, greatest = i;
    for (; end < curve.points.size() && std::isfinite(curve.points[end].value) &&
           std::floor(x(curve.points[end].at)) == left; ++end) {
      if (curve.points[end].value < curve.points[least].value) least = end;
      if (curve.points[end].value > curve.points[greatest].value) greatest = end;
    }
    std::size_t shown[] = {i, std::min(least, greatest), std::max(least, greatest), end - 1};
    for (std::size_t k = 0; k < 4; ++k)
      if (k == 0 || shown[k] != shown[k - 1]) to(x(curve.points[shown[k]].at), y(panel, curve.points[shown[k]].value));
    if (i + 1 == end && (i == 0 || !std::isfinite(curve.points[i - 1].value)) &&
        (end == curve.points.size() || !std::isfinite(curve.points[end].value)))
      to(x(curve.points[i].at), y(panel, curve.points[i].value));
    return end;
  }

  static std::string style(std::size_t index) {
    const std::size_t colours = std::size(kColours);
    const std::string dash = kDashes[index / colours % std::size(kDashes)];
    return std::string("class=\"curve\" stroke=\"") + kColours[index % colours] + "\"" +
           (dash.empty() ? "" : " stroke-dasharray=\"" + dash + "\"");
  }

  const Plot& plot_;
  std::vector<Panel> panels_;
  ValueRange times_;
  std::string body_;
};

}  // namespace

std::vector<double> axis_marks(double low, double high, int wanted) {
  std::vector<double> marks;
  if (!(low < high) || wanted < 2) return marks;
  const double raw = (high - low) / wanted;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  double step = power * 10;
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power * (1 + 1e-9)) {
      step = factor * power;
      break;
    }
  const auto in_range = [&](double size) { return std::floor(high / size) - std::ceil(low / size) + 1; };
  while (in_range(step) < 2) step /= 2;
  const double first = std::ceil(low / step - 1e-9), last = std::floor(high / step + 1e-9);
  for (double i = first; i <= last; ++i) marks.push_back(i == 0 ? 0 : i * step);
  return marks;
}

std::vector<double> decade_marks(double low, double high) {
  std::vector<double> marks;
  if (!(low > 0 && low < high)) return marks;
  const double slack = 1 + 1e-9;
  for (auto power = static_cast<int>(std::floor(std::log10(low))); power <= std::log10(high) + 1; ++power)
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double at = factor * std::pow(10, power);
      if (at * slack >= low && at <= high * slack) marks.push_back(at);
    }
  return marks;
}

std::string svg(const Plot& plot) { return PlotPage(plot).document(); }

}  // namespace chimera::draw
